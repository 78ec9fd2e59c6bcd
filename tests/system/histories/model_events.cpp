// Events of skills that no command causes, and the holder of control.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "model.hpp"

namespace metier::system_tests {

using skill::OwnerLossAction;
using skill::Reason;
using skill::State;
using skill::SubState;

namespace {

constexpr const char* kGood = "Good";
constexpr const char* kLocked = "BadLocked";
constexpr const char* kLockDone = "Good 0";
constexpr const char* kLockRefused = "Good -1";

}  // namespace

std::string Model::control(const Step& step) {
    switch (step.act) {
        case Act::acquire:
            return acquire(step.client, step.value);
        case Act::heartbeat:
            if (!holdsLease(step.client)) {
                return kLocked;
            }
            leased_until_ = now_ + Times::kLease;
            return kGood;
        case Act::release:
            if (!holdsLease(step.client)) {
                return kLocked;
            }
            leased_.reset();
            return kGood;
        default:
            return lock(step);
    }
}

std::string Model::acquire(std::size_t client, std::uint32_t action) {
    if (!isFree(sessions_.at(client))) {
        return kLocked;
    }
    stale_.erase(sessions_.at(client));
    leased_ = sessions_.at(client);
    lease_ = ++leases_;
    epochs_.at(client) = lease_;
    lease_action_ = static_cast<OwnerLossAction>(action % 4);
    leased_until_ = now_ + Times::kLease;
    return kGood;
}

bool Model::holdsLease(std::size_t client) const {
    return leased_ == sessions_.at(client) && epochs_.at(client) == lease_;
}

std::string Model::lock(const Step& step) {
    const auto session = sessions_.at(step.client);
    switch (step.act) {
        case Act::init_lock:
            if (!isFree(session)) {
                return kLockRefused;
            }
            stale_.erase(session);
            locked_ = session;
            locked_until_ = now_ + Times::kLock;
            return kLockDone;
        case Act::renew_lock:
            if (locked_ != session) {
                return kLockRefused;
            }
            locked_until_ = now_ + Times::kLock;
            return kLockDone;
        case Act::exit_lock:
            return locked_ == session ? (locked_.reset(), kLockDone) : kLockRefused;
        default:
            return std::exchange(locked_, std::nullopt) ? kLockDone : kLockRefused;
    }
}

void Model::happen(SkillModel& skill, const Step& step) {
    switch (step.act) {
        case Act::close_session:
            return closeSession(step.client);
        case Act::cut_connection:
            sessions_.at(step.client) += kClients;
            return;
        case Act::at_rest:
            return atRest(skill);
        case Act::finish:
            return finish(skill);
        case Act::force_exceeded:
            if (skill.hasWork()) {
                go(skill, State::halted, Reason::force_exceeded);
            }
            return;
        case Act::device_lost:
            if (skill.state == State::halted) {
                skill.sub_state = SubState::halted_device_lost;
            } else {
                go(skill, State::halted, Reason::device_lost);
            }
            return;
        case Act::fault_stays:
        case Act::fault_is_gone:
            skill.fault_stays = step.act == Act::fault_stays;
            return;
        default:
            return wait(static_cast<std::int64_t>(step.value % 1'024) * 10);
    }
}

void Model::atRest(SkillModel& skill) {
    if (skill.sub_state != SubState::stopping) {
        return;
    }
    if (skill.halting) {
        go(skill, State::halted, *skill.halting);
    } else {
        go(skill, State::suspended, skill.suspending);
    }
}

void Model::finish(SkillModel& skill) {
    if (skill.state == State::suspended) {
        skill.done = true;
    } else if (skill.state == State::running && skill.halting) {
        go(skill, State::halted, *skill.halting);
    } else if (skill.state == State::running) {
        skill.result = numberText(skill.started_speed);
        go(skill, State::ready, Reason::finished);
    }
}

void Model::closeSession(std::size_t client) {
    const auto session = std::exchange(sessions_.at(client), sessions_.at(client) + kClients);
    if (locked_ == session) {
        locked_.reset();
    }
    if (leased_ == session) {
        loseLease();
    }
    for (auto& skill : skills_) {
        if (skill.bound == session) {
            endConfiguration(skill);
        }
        if (skill.hasWork() && skill.owner == session) {
            loseOwner(skill, OwnerLossAction::skill_default);
        }
    }
}

void Model::loseLease() {
    const auto session = std::exchange(leased_, std::nullopt);
    for (auto& skill : skills_) {
        if (skill.bound == session) {
            endConfiguration(skill);
        }
        if (skill.hasWork() && skill.owner == session) {
            loseOwner(skill, lease_action_);
        }
    }
}

void Model::loseOwner(SkillModel& skill, OwnerLossAction of_lease) const {
    auto action = skill.on_owner_loss;
    if (action == OwnerLossAction::skill_default) {
        action = of_lease;
    }
    if (action == OwnerLossAction::skill_default) {
        action = skill.isFirst ? OwnerLossAction::halt : OwnerLossAction::keep_going;
    }
    skill.owner.reset();
    if (action == OwnerLossAction::keep_going) {
        return;
    }
    if (skill.state == State::suspended || skill.halting) {
        return;
    }
    const bool stopping = skill.sub_state == SubState::stopping;
    if (action == OwnerLossAction::halt || (!stopping && !skill.isFirst)) {
        brake(skill, Reason::owner_lost, now_);
    } else if (!stopping) {
        skill.suspending = Reason::owner_lost;
        stop(skill, now_);
    }
}

void Model::wait(std::int64_t time) {
    const auto end = now_ + time;
    for (auto due = nextDue(); due && *due <= end; due = nextDue()) {
        now_ = *due;
        fallDue();
    }
    now_ = end;
}

std::optional<std::int64_t> Model::nextDue() const {
    std::optional<std::int64_t> next;
    const auto consider = [&](bool set, std::int64_t due) {
        if (set && (!next || due < *next)) {
            next = due;
        }
    };
    consider(leased_.has_value(), leased_until_);
    consider(locked_.has_value(), locked_until_);
    for (const auto& skill : skills_) {
        consider(skill.bound.has_value(), skill.bound_until);
        consider(skill.rest_until.has_value(), skill.rest_until.value_or(0));
    }
    return next;
}

void Model::fallDue() {
    if (leased_ && leased_until_ <= now_) {
        stale_.insert(*leased_);
        loseLease();
    }
    if (locked_ && locked_until_ <= now_) {
        locked_.reset();
    }
    for (auto& skill : skills_) {
        if (skill.bound && skill.bound_until <= now_) {
            endConfiguration(skill);
        }
        if (skill.rest_until && *skill.rest_until <= now_) {
            const bool owner_lost = skill.halting.value_or(skill.suspending) == Reason::owner_lost;
            go(skill, State::halted, owner_lost ? Reason::owner_lost : Reason::error);
        }
    }
}

}  // namespace metier::system_tests
