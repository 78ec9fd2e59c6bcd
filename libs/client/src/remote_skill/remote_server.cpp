#include "metier/client/remote_server.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "remote_skill/connection.hpp"
#include "remote_skill/remote_used_skill.hpp"

namespace metier::client {

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
        std::make_unique<Connection>(std::move(options), std::move(*client)), std::move(executor)));
}

RemoteServer::RemoteServer(std::unique_ptr<Connection> connection,
                           std::shared_ptr<skill::Executor> executor)
    : connection_(std::move(connection)), executor_(std::move(executor)) {}

RemoteServer::~RemoteServer() = default;

const std::string& RemoteServer::url() const noexcept {
    return connection_->options().url;
}

const std::string& RemoteServer::name() const noexcept {
    return connection_->options().name;
}

std::optional<SteadyTime> RemoteServer::awaySince() const {
    return connection_->awaySince();
}

opcua::Client& RemoteServer::client() {
    return connection_->client();
}

Result<std::vector<client::SkillAddress>> RemoteServer::skills() {
    METIER_ASSIGN(auto found, client::findSkills(connection_->client()));
    return found;
}

Result<std::unique_ptr<composition::UsedSkill>> RemoteServer::use(const client::SkillAddress& skill,
                                                                  std::string origin) {
    METIER_ASSIGN(auto opened, open(skill, std::move(origin)));
    return usedSkill(std::move(opened));
}

Result<PendingUse> RemoteServer::open(const client::SkillAddress& skill, std::string origin) {
    const auto link = std::make_shared<UsedSkillLink>(executor_);
    METIER_ASSIGN(auto open, connection_->open(skill, link));
    METIER_ASSIGN(const auto now, open->skill.now());
    if (const auto lacks = open->skill.lacks(); !lacks.empty()) {
        spdlog::warn("{}: {} has {}", url(), skill.name, explanationOf(lacks));
    }
    return PendingUse{link, std::move(open), now, fmt::format("{} of {}", skill.name, name()),
                      std::move(origin)};
}

std::unique_ptr<composition::UsedSkill> RemoteServer::usedSkill(PendingUse use) {
    auto used = std::make_unique<RemoteUsedSkill>(*connection_, use.link, std::move(use.name),
                                                  std::move(use.origin));
    used->adopt(use.skill, use.now);
    // No used has got the events since it was opened.
    connection_->run([skill = std::move(use.skill), link = std::move(use.link)] {
        if (const auto now = skill->skill.now()) {
            link->post([now = *now](RemoteUsedSkill& other) { other.refresh(now); });
        }
    });
    return used;
}

}  // namespace metier::client
