#include "skill_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <utility>

#include "metier/base/random.hpp"
#include "metier/opcua/text.hpp"

namespace metier::dashboard {

using client::AsyncSkill;
using skill::State;

namespace {

constexpr std::size_t kIdDigits = 24;

bool isOver(State state) {
    return state == State::ready || state == State::halted;
}

/// Whether the server says that a skill stands still.
bool stands(const AsyncSkill& skill) {
    const auto now = skill.now();
    return now && isOver(now->state);
}

/// Halts a skill, unless it stands still already. \return why it goes on; empty if it does not
std::string haltUnlessOver(const AsyncSkill& skill) {
    if (stands(skill)) {
        return {};
    }
    const auto halted = awaitAnswer<void>(
        [&](auto done) { return skill.call(skill::Method::halt, std::move(done)); });
    return halted || stands(skill) ? "" : explained(halted.error(), skill, "Halt").message;
}

}  // namespace

bool StartedRun::begin(bool at_rest) {
    const std::lock_guard lock(mutex_);
    if (starting_ || !(over_ || at_rest)) {
        return false;
    }
    starting_ = true;
    was_over_ = std::exchange(over_, false);  // before its end can be reported
    ++starts_;
    return true;
}

void StartedRun::answered(bool started) {
    const std::lock_guard lock(mutex_);
    starting_ = false;
    if (!started) {
        --starts_;
        running_ = std::min(running_, starts_);
        over_ = was_over_;
    }
}

void StartedRun::note(State now) {
    const std::lock_guard lock(mutex_);
    if (now == State::running) {
        running_ = std::min(running_ + 1, starts_);
    } else if (dashboard::isOver(now) && running_ == starts_) {
        over_ = true;
    }
}

bool StartedRun::isOver() const {
    const std::lock_guard lock(mutex_);
    return over_;
}

opcua::Answer<SkillSession::Used> SkillSession::use(const LinkedSkill& linked) {
    {
        const std::lock_guard lock(mutex_);
        if (const auto known = skills_.find(linked.key); known != skills_.end()) {
            return known->second;
        }
    }
    auto run = std::make_shared<StartedRun>();
    auto record = std::make_shared<ForeignRun>(store_);
    const auto note = [run, record](const skill::TransitionEvent& event) {
        run->note(event.to);
        record->note(event);
    };
    METIER_ASSIGN(auto opened,
                  AsyncSkill::open(
                      *client_, linked.address,
                      {.on_transition = note, .on_missed = [record] { record->look(); }}, locks_));
    Used used{std::make_shared<AsyncSkill>(std::move(opened)), std::move(run), std::move(record)};
    const std::lock_guard lock(mutex_);
    return skills_.try_emplace(linked.key, std::move(used)).first->second;
}

opcua::Answer<std::shared_ptr<AsyncSkill>> SkillSession::skill(const LinkedSkill& linked) {
    return use(linked).map([](Used used) { return std::move(used.skill); });
}

opcua::Answer<std::string> SkillSession::start(const LinkedSkill& linked,
                                               const skill::StartRequest& request) {
    METIER_ASSIGN(const auto used, use(linked));
    if (used.skill->knowsExecutions()) {
        return awaitAnswer<std::string>(
            [&](auto done) { return used.skill->startWith(request, std::move(done)); });
    }
    auto named = request;
    if (named.execution_id.empty()) {
        named.execution_id = randomHex(kIdDigits);
    }
    const bool at_rest = !used.run->isOver() && stands(*used.skill);
    if (!used.run->begin(at_rest)) {
        return opcua::failed(opcua::status::kBadInvalidState, "it runs already");
    }
    used.record->begin(used.skill, named);
    auto id = awaitAnswer<std::string>(
        [&](auto done) { return used.skill->startWith(named, std::move(done)); });
    used.record->answered(id);
    used.run->answered(id || id.error().delivery != opcua::Failure::Delivery::answered);
    return id;
}

std::vector<std::string> SkillSession::haltStarted() {
    std::vector<Used> running;
    {
        const std::lock_guard lock(mutex_);
        for (const auto& [key, used] : skills_) {
            if (!used.skill->knowsExecutions() && !used.run->isOver()) {
                running.push_back(used);
            }
        }
    }
    std::vector<std::future<std::string>> halted;
    for (const auto& used : running) {
        halted.push_back(std::async(std::launch::async, [used] {
            used.record->expectHalt("nobody at the page has control any more");
            auto why = haltUnlessOver(*used.skill);
            if (why.empty()) {
                used.record->settle();
            }
            return why;
        }));
    }
    std::vector<std::string> not_halted;
    for (auto& answer : halted) {
        if (auto why = answer.get(); !why.empty()) {
            not_halted.push_back(std::move(why));
        }
    }
    return not_halted;
}

void SkillSession::expectHalt(const std::string& key) {
    const std::lock_guard lock(mutex_);
    if (const auto used = skills_.find(key); used != skills_.end()) {
        used->second.record->expectHalt("halted at the page");
    }
}

Error explained(const opcua::Failure& failure, const AsyncSkill& skill, std::string_view what) {
    const auto& name = skill.address().name;
    if (failure.delivery != opcua::Failure::Delivery::answered) {
        return {failure.code,
                opcua::sanitise(fmt::format("{} {}: {}", name, what, failure.message))};
    }
    if (failure.status == opcua::status::kBadUserAccessDenied) {
        return {Errc::access_denied,
                fmt::format("{} refused {}: this user may not command", name, what)};
    }
    const auto now = skill.now();
    const auto reason = now ? opcua::sanitise(now->reason_text) : "";
    return {failure.code, fmt::format("{} refused {}: {}", name, what,
                                      reason.empty() ? failure.status.name() : reason)};
}

}  // namespace metier::dashboard
