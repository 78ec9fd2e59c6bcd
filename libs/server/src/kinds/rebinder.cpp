#include "kinds/rebinder.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <future>
#include <map>
#include <utility>

#include "metier/opcua_skill/used_skills.hpp"

namespace metier::server {
namespace {

using Children = std::map<std::string, std::unique_ptr<composition::Child>>;
using namespace std::chrono_literals;

constexpr auto kLookEvery = 500ms;
constexpr auto kPause = 2s;        // after an attempt that changed nothing
constexpr auto kLongestTurn = 5s;  // until the executor gets to something

}  // namespace

/// A server that was given up, with the children that watch what still runs there.
struct Rebinder::Former {
    std::shared_ptr<client::RemoteServer> server;
    std::shared_ptr<Children> children;
};

/// An exchange of servers, for the executor's thread and back.
struct Rebinder::Exchange {
    std::shared_ptr<client::RemoteServer> server;
    std::map<std::string, OfferedSkill> chosen;
    std::map<std::string, client::PendingUse> pending{};
    std::shared_ptr<Children> children = std::make_shared<Children>();
};

Rebinder::Rebinder(Setup setup, std::vector<Bond> bonds)
    : setup_(std::move(setup)),
      bonds_(std::move(bonds)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Rebinder::~Rebinder() {
    stop();
}

void Rebinder::stop() {
    thread_.request_stop();
    thread_ = {};
    for (auto& former : formers_) {
        static_cast<void>(onExecutor([children = former.children]() -> Result<void> {
            children->clear();
            return {};
        }));
    }
    formers_.clear();
}

void Rebinder::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        {
            std::unique_lock lock(mutex_);
            wake_.wait_for(lock, stop, kLookEvery, [] { return false; });
        }
        for (auto& bond : bonds_) {
            const auto since = bond.server->awaySince();
            const auto now = std::chrono::steady_clock::now();
            const bool due = since && now - *since > setup_.rebind_after && now >= bond.next_try;
            if (due && !stop.stop_requested()) {
                renew(bond);
            }
        }
        forget();
    }
}

void Rebinder::renew(Bond& bond) {
    const auto idle = onExecutor([&bond]() -> Result<void> {
        return bond.skill->underWay() ? fail(Errc::invalid_state, "it runs") : Result<void>{};
    });
    if (!idle) {
        return;  // in the middle of an execution nothing changes
    }
    const auto servers =
        discoverServers(setup_.discovery, setup_.identity, {setup_.own_url, bond.server->url()});
    Result<void> moved = fail(Errc::not_found, "nobody else is found");
    for (const auto& server : servers) {
        moved = moveTo(server, bond);
        if (moved || moved.error().code == Errc::invalid_state) {
            break;  // it has begun to run, or the server is back
        }
    }
    if (!moved) {
        bond.next_try = std::chrono::steady_clock::now() + kPause;
        tell(bond, moved.error());
    }
}

Result<void> Rebinder::moveTo(const DiscoveredServer& other, Bond& bond) {
    auto chosen = chooseAll(bond.uses, other);
    if (!chosen) {
        return fail(std::move(chosen.error()));
    }
    auto server = client::RemoteServer::connect({.url = other.found.url,
                                                       .name = chosen->begin()->second.server,
                                                       .application_name = setup_.application_name,
                                                       .security = setup_.identity.credentials(),
                                                       .own_server = setup_.own_server},
                                                      setup_.executor);
    if (!server) {
        return fail(std::move(server.error()));
    }
    Exchange parts{.server = std::move(*server), .chosen = std::move(*chosen)};
    for (const auto& [alias, skill] : parts.chosen) {
        auto opened = parts.server->open(skill.address, bond.origin);
        if (!opened) {
            return fail(std::move(opened.error()));
        }
        parts.pending.emplace(alias, std::move(*opened));
    }
    return exchange(parts, bond);
}

/// On the executor's thread: the children are made, and change places with those of before.
Result<void> Rebinder::exchange(Exchange& parts, Bond& bond) {
    const auto former = bond.server;
    auto done = onExecutor([this, &parts, &bond]() -> Result<void> {
        auto& children = *parts.children;
        for (auto& [alias, use] : parts.pending) {
            children.emplace(alias, parts.server->child(std::move(use)));
        }
        // A server that came back in the meantime stays.
        auto rebound = bond.server->awaySince()
                           ? bond.skill->rebind(children)
                           : fail(Errc::invalid_state, bond.server->url() + " is back");
        if (!rebound) {
            children.clear();
            return rebound;
        }
        show(parts, bond);
        return {};
    });
    if (!done) {
        return done;
    }
    bond.server = parts.server;
    formers_.push_back({former, parts.children});
    told_.clear();
    spdlog::warn("{} uses {} ({}) from its next execution on, since {} ({}) is away",
                 bond.skill_name, bond.server->name(), bond.server->url(), former->name(),
                 former->url());
    return {};
}

/// In the address space, on the executor's thread.
void Rebinder::show(const Exchange& parts, const Bond& bond) {
    for (const auto& [alias, skill] : parts.chosen) {
        const auto told =
            opcua_skill::updateUse(setup_.nodes, bond.node,
                                   {alias, parts.server->url(), skill.address.name,
                                    skill.address.type_name, skill.address.controllerName()});
        if (!told) {
            spdlog::error("{}: {}", bond.skill_name, told.error().message);
        }
    }
}

/// Those that are back: what was left there has been seen to.
void Rebinder::forget() {
    std::erase_if(formers_, [this](const Former& former) {
        if (former.server->awaySince()) {
            return false;
        }
        return onExecutor([children = former.children]() -> Result<void> {
                   children->clear();
                   return {};
               })
            .has_value();
    });
}

/// Work that has not begun at the deadline never will; work that has goes on to its end, which is
/// soon.
Result<void> Rebinder::onExecutor(std::function<Result<void>()> work) {
    // Both are shared: the promise because posted work is copied, the mark with this function.
    auto promise = std::make_shared<std::promise<Result<void>>>();
    const auto taken = std::make_shared<std::atomic<bool>>(false);
    auto outcome = promise->get_future();
    setup_.executor->post([promise = std::move(promise), taken, work = std::move(work)] {
        if (!taken->exchange(true)) {
            promise->set_value(work());
        }
    });
    if (outcome.wait_for(kLongestTurn) != std::future_status::ready && !taken->exchange(true)) {
        return fail(Errc::timeout, "the server's thread is busy");
    }
    try {
        return outcome.get();
    } catch (const std::future_error&) {
        return fail(Errc::cancelled, "the server stopped");
    }
}

void Rebinder::tell(const Bond& bond, const Error& error) {
    auto text = fmt::format("{}: {} ({}) is away; no other: {}", bond.skill_name,
                            bond.server->name(), bond.server->url(), error.message);
    if (text != told_) {
        spdlog::warn("{}", text);
        told_ = std::move(text);
    }
}

}  // namespace metier::server
