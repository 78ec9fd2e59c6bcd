#include "watches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace metier::dashboard {

Watches::Watches(Board& board, const Connector& connector,
                 const std::vector<motion::RobotModel>& models)
    : board_(board), connector_(connector), models_(models) {}

void Watches::add(const CellServer& server) {
    const std::lock_guard lock(mutex_);
    const bool known = std::any_of(known_.begin(), known_.end(), [&](const CellServer& one) {
        return one.name == server.name || one.url == server.url;
    });
    if (known) {
        return;
    }
    known_.push_back(server);
    board_.addServer(server.name, server.name, server.url);
    watches_.push_back(std::make_unique<ServerWatch>(
        LinkContext{server, [this](const std::string& at) { return serverAt(at); }, models_,
                    board_},
        connector_));
    watches_.back()->showLive(live_);
}

std::string Watches::serverAt(const std::string& url) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(known_.begin(), known_.end(),
                                    [&](const CellServer& one) { return one.url == url; });
    return found == known_.end() ? "" : found->name;
}

void Watches::end() {
    std::vector<std::unique_ptr<ServerWatch>> ending;
    {
        const std::lock_guard lock(mutex_);
        ending.swap(watches_);
    }
}

void Watches::showLive(bool shown) {
    const std::lock_guard lock(mutex_);
    live_ = shown;
    for (const auto& watch : watches_) {
        watch->showLive(shown);
    }
}

std::vector<std::string> Watches::servers() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> names;
    for (const auto& server : known_) {
        names.push_back(server.name);
    }
    return names;
}

std::shared_ptr<ServerLink> Watches::link(const std::string& server) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(watches_.begin(), watches_.end(), [&](const auto& watch) {
        return watch->server().name == server;
    });
    return found == watches_.end() ? nullptr : (*found)->link();
}

Result<std::string> Watches::url(const std::string& server) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(known_.begin(), known_.end(),
                                    [&](const CellServer& one) { return one.name == server; });
    return found == known_.end() ? fail(Errc::not_found, fmt::format("no server '{}'", server))
                                 : Result<std::string>(found->url);
}

Result<ReachedSkill> Watches::skill(const std::string& key) const {
    const auto server = key.substr(0, key.find('/'));
    if (const auto known = url(server); !known) {
        return fail(Errc::not_found, fmt::format("no skill '{}'", key));
    }
    ReachedSkill reached{link(server)};
    if (!reached.link) {
        return fail(Errc::connection_lost, fmt::format("{} is not connected", server));
    }
    reached.skill = reached.link->find(key);
    return reached.skill == nullptr ? fail(Errc::not_found, fmt::format("no skill '{}'", key))
                                    : Result<ReachedSkill>(std::move(reached));
}

std::map<std::string, std::string> Watches::usedServers() const {
    const std::lock_guard lock(mutex_);
    std::map<std::string, std::string> used;
    for (const auto& watch : watches_) {
        const auto& user = watch->server();
        // Uses in the cell file are shown even before the server was reached.
        for (const auto& name : user.uses) {
            used.emplace(name, user.name);
        }
        const auto link = watch->link();
        for (const auto& name : link ? link->offer().uses : std::set<std::string>()) {
            used.emplace(name, user.name);
        }
    }
    return used;
}

}  // namespace metier::dashboard
