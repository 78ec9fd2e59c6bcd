#include "kinds/rebinder.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <future>
#include <map>
#include <utility>

#include "host/skill_host.hpp"
#include "kinds/compositions.hpp"
#include "kinds/forces.hpp"
#include "kinds/look_times.hpp"
#include "metier/opcua_skill/used_skills.hpp"

namespace metier::server {
namespace {

using namespace std::chrono_literals;

constexpr auto kLongestTurn = 5s;  // longest time until the executor gets to something

}  // namespace

/// A server that was given up, with the used skills that watch what still runs there.
struct Rebinder::Former {
    std::shared_ptr<client::RemoteServer> server;
    std::shared_ptr<UsedSkills> used_skills;
};

/// An exchange of servers, for the executor's thread and back.
struct Rebinder::Exchange {
    std::shared_ptr<client::RemoteServer> server;
    std::map<std::string, OfferedSkill> chosen;
    std::map<std::string, client::PendingUse> pending{};
    std::shared_ptr<UsedSkills> used_skills = std::make_shared<UsedSkills>();
};

Rebinder::Rebinder(Setup setup, std::vector<SkillBinding> bindings)
    : setup_(std::move(setup)),
      bindings_(std::move(bindings)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Rebinder::~Rebinder() {
    stop();
}

void Rebinder::stop() {
    thread_.request_stop();
    thread_ = {};
    for (const auto& former : formers_) {
        static_cast<void>(letGoOf(former));
    }
    formers_.clear();
}

void Rebinder::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        {
            std::unique_lock lock(mutex_);
            wake_.wait_for(lock, stop, kLookEvery, [] { return false; });
        }
        for (auto& binding : bindings_) {
            const auto since = binding.server->awaySince();
            const auto now = std::chrono::steady_clock::now();
            const bool due = since && now - *since > setup_.rebind_after && now >= binding.next_try;
            if (due && !stop.stop_requested()) {
                renew(binding);
            }
        }
        forget();
    }
}

void Rebinder::renew(SkillBinding& binding) {
    const auto idle = onExecutor([&binding]() -> Result<void> {
        return binding.skill->underWay() ? fail(Errc::invalid_state, "it runs") : Result<void>{};
    });
    if (!idle) {
        return;  // nothing changes during an execution
    }
    const auto servers =
        discoverServers(setup_.discovery, setup_.identity, {setup_.own_url, binding.server->url()});
    Result<void> moved = fail(Errc::not_found, "nobody else is found");
    for (const auto& server : servers) {
        moved = moveTo(server, binding);
        if (moved || moved.error().code == Errc::invalid_state) {
            break;  // it has begun to run, or the server is back
        }
    }
    if (!moved) {
        binding.next_try = std::chrono::steady_clock::now() + kPause;
        tell(binding, moved.error());
    }
}

Result<void> Rebinder::moveTo(const DiscoveredServer& other, SkillBinding& binding) {
    METIER_ASSIGN(auto chosen, chooseAll(binding.uses, other));
    METIER_ASSIGN(auto server,
                  client::RemoteServer::connect({.url = other.found.url,
                                                 .name = chosen.begin()->second.server,
                                                 .application_name = setup_.application_name,
                                                 .security = setup_.identity.credentials(),
                                                 .own_server = setup_.own_server},
                                                setup_.executor));
    Exchange parts{.server = std::move(server), .chosen = std::move(chosen)};
    for (const auto& [alias, skill] : parts.chosen) {
        METIER_ASSIGN(auto opened, parts.server->open(skill.address, binding.origin));
        parts.pending.emplace(alias, std::move(opened));
    }
    return exchange(parts, binding);
}

/// On the executor's thread: the used skills are made, and take the places of the former ones.
Result<void> Rebinder::exchange(Exchange& parts, SkillBinding& binding) {
    const auto former = binding.server;
    auto done = onExecutor([this, &parts, &binding]() -> Result<void> {
        auto& used_skills = *parts.used_skills;
        for (const auto& use : binding.uses) {
            const auto& address = parts.chosen.at(use.alias).address;
            auto recorded = setup_.host.recorded(
                parts.server->usedSkill(std::move(parts.pending.at(use.alias))),
                {parts.server->name(), address.controllerName(), address.name});
            auto limited = setup_.forces.limit(use, std::move(recorded));
            if (!limited) {
                used_skills.clear();
                return fail(std::move(limited.error()));
            }
            used_skills.emplace(use.alias, std::move(*limited));
        }
        // A server that came back in the meantime stays.
        auto rebound = binding.server->awaySince()
                           ? binding.skill->rebind(used_skills)
                           : fail(Errc::invalid_state, binding.server->url() + " is back");
        if (!rebound) {
            used_skills.clear();
            return rebound;
        }
        show(parts, binding);
        return {};
    });
    if (!done) {
        return done;
    }
    binding.server = parts.server;
    formers_.push_back({former, parts.used_skills});
    reported_.clear();
    spdlog::warn("{} uses {} ({}) from its next execution on, since {} ({}) is away",
                 binding.skill_name, binding.server->name(), binding.server->url(), former->name(),
                 former->url());
    return {};
}

/// In the address space, on the executor's thread.
void Rebinder::show(const Exchange& parts, const SkillBinding& binding) {
    for (const auto& [alias, skill] : parts.chosen) {
        const auto told =
            opcua_skill::updateUse(setup_.host.nodes(), binding.node,
                                   {alias, parts.server->url(), skill.address.name,
                                    skill.address.type_name, skill.address.controllerName()});
        if (!told) {
            spdlog::error("{}: {}", binding.skill_name, told.error().message);
        }
    }
}

/// Those that are back: what was left there has been seen to.
void Rebinder::forget() {
    std::erase_if(formers_, [this](const Former& former) {
        return !former.server->awaySince() && letGoOf(former);
    });
}

Result<void> Rebinder::letGoOf(const Former& former) {
    return onExecutor([used_skills = former.used_skills]() -> Result<void> {
        used_skills->clear();
        return {};
    });
}

/// Runs work on the executor's thread. If it has not begun at the deadline it never will; work that
/// has begun goes on to its end, which is soon.
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

void Rebinder::tell(const SkillBinding& binding, const Error& error) {
    auto text = fmt::format("{}: {} ({}) is away; no other: {}", binding.skill_name,
                            binding.server->name(), binding.server->url(), error.message);
    if (text != reported_) {
        spdlog::warn("{}", text);
        reported_ = std::move(text);
    }
}

}  // namespace metier::server
