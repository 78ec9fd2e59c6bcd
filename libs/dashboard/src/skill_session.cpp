#include "skill_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "metier/opcua/text.hpp"

namespace metier::dashboard {

using client::AsyncSkill;
using skill::State;

namespace {

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
    const auto note = [run](const skill::TransitionEvent& event) { run->note(event.to); };
    METIER_ASSIGN(auto opened,
                  AsyncSkill::open(*client_, linked.address, {.on_transition = note}, locks_));
    Used used{std::make_shared<AsyncSkill>(std::move(opened)), std::move(run)};
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
    const bool at_rest = !used.run->isOver() && stands(*used.skill);
    if (!used.run->begin(at_rest)) {
        return opcua::failed(opcua::status::kBadInvalidState, "it runs already");
    }
    auto id = awaitAnswer<std::string>(
        [&](auto done) { return used.skill->startWith(request, std::move(done)); });
    used.run->answered(id || id.error().delivery != opcua::Failure::Delivery::answered);
    return id;
}

std::vector<std::string> SkillSession::haltStarted() {
    std::vector<std::shared_ptr<client::AsyncSkill>> running;
    {
        const std::lock_guard lock(mutex_);
        for (const auto& [key, used] : skills_) {
            if (!used.skill->knowsExecutions() && !used.run->isOver()) {
                running.push_back(used.skill);
            }
        }
    }
    std::vector<std::future<std::string>> halted;
    for (const auto& skill : running) {
        halted.push_back(
            std::async(std::launch::async, [skill] { return haltUnlessOver(*skill); }));
    }
    std::vector<std::string> not_halted;
    for (auto& answer : halted) {
        if (auto why = answer.get(); !why.empty()) {
            not_halted.push_back(std::move(why));
        }
    }
    return not_halted;
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
