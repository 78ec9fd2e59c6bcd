#include "metier/client/remote_server.hpp"

#include <fmt/format.h>

#include <utility>

#include "remote_skill/connection.hpp"
#include "remote_skill/remote_used_skill.hpp"

namespace metier::client {

class RemoteServer::Worker {
public:
    Worker(RemoteServerOptions options, std::unique_ptr<opcua::Client> client,
           std::shared_ptr<skill::Executor> owner)
        : connection(std::move(options), std::move(client)), executor(std::move(owner)) {}

    Connection connection;
    std::shared_ptr<skill::Executor> executor;  // shared by what its thread owns
};

Result<std::unique_ptr<RemoteServer>> RemoteServer::connect(
    RemoteServerOptions options, std::shared_ptr<skill::Executor> executor) {
    if (options.name.empty()) {
        options.name = options.url;
    }
    auto client = Connection::connect(options);
    if (!client) {
        return fail(client.error().code,
                    fmt::format("{}: {}", options.url, client.error().message));
    }
    return std::unique_ptr<RemoteServer>(new RemoteServer(
        std::make_unique<Worker>(std::move(options), std::move(*client), std::move(executor))));
}

RemoteServer::RemoteServer(std::unique_ptr<Worker> worker) : worker_(std::move(worker)) {}

RemoteServer::~RemoteServer() = default;

const std::string& RemoteServer::url() const noexcept {
    return worker_->connection.options().url;
}

const std::string& RemoteServer::name() const noexcept {
    return worker_->connection.options().name;
}

std::optional<SteadyTime> RemoteServer::awaySince() const {
    return worker_->connection.awaySince();
}

opcua::Client& RemoteServer::client() {
    return worker_->connection.client();
}

Result<std::vector<client::SkillAddress>> RemoteServer::skills() {
    auto found = client::findSkills(worker_->connection.client());
    return found ? Result<std::vector<client::SkillAddress>>(std::move(*found))
                 : fail(found.error());
}

Result<std::unique_ptr<composition::UsedSkill>> RemoteServer::use(const client::SkillAddress& skill,
                                                                  std::string origin) {
    auto opened = open(skill, std::move(origin));
    return opened
               ? usedSkill(std::move(*opened))
               : Result<std::unique_ptr<composition::UsedSkill>>(fail(std::move(opened.error())));
}

Result<PendingUse> RemoteServer::open(const client::SkillAddress& skill, std::string origin) {
    const auto link = std::make_shared<UsedSkillLink>(worker_->executor);
    METIER_ASSIGN(auto open, worker_->connection.open(skill, link));
    METIER_ASSIGN(const auto now, open->skill.now());
    if (!open->skill.knowsExecutions()) {
        return fail(Errc::not_supported,
                    fmt::format("{}: {} has no StartWith and GetExecution", url(), skill.name));
    }
    return PendingUse{link, std::move(open), now, fmt::format("{} of {}", skill.name, name()),
                      std::move(origin)};
}

std::unique_ptr<composition::UsedSkill> RemoteServer::usedSkill(PendingUse use) {
    auto used = std::make_unique<RemoteUsedSkill>(worker_->connection, use.link,
                                                  std::move(use.name), std::move(use.origin));
    used->adopt(use.skill, use.now);
    // No used has got the events since it was opened.
    worker_->connection.run([skill = std::move(use.skill), link = std::move(use.link)] {
        if (const auto now = skill->skill.now()) {
            link->post([now = *now](RemoteUsedSkill& other) { other.refresh(now); });
        }
    });
    return used;
}

}  // namespace metier::client
