#include "remote_arm/notes.hpp"

#include <chrono>

namespace metier::client {
namespace {

// A change of the measured arm since it was last seen in motion that counts as motion [rad].
constexpr double kMotion = 1e-5;

void enter(Observed& seen, skill::State state) {
    if (seen.skill != state) {
        seen.skill = state;
        seen.skill_since = std::chrono::steady_clock::now();
    }
}

}  // namespace

Observed Notes::observed() const {
    const std::lock_guard lock(mutex_);
    return observed_;
}

void Notes::notePosition(const device::JointArray& position) {
    note([&](Observed& seen) {
        seen.sampled = std::chrono::steady_clock::now();
        if (seen.place.size() != position.size()) {
            seen.place = position;  // the first
        } else if (device::largestDifference(seen.place, position) > kMotion) {
            seen.moved = seen.sampled;
            seen.place = position;
        }
        seen.position = position;
    });
}

void Notes::noteBroken(const std::string& why) {
    note([&](Observed& seen) {
        if (seen.broken.empty()) {
            seen.broken = why;
        }
    });
}

std::uint64_t Notes::noteWrite() {
    const std::lock_guard lock(mutex_);
    unanswered_.emplace(++writes_, std::chrono::steady_clock::now());
    return writes_;
}

SteadyTime Notes::oldestUnanswered() const {
    const std::lock_guard lock(mutex_);
    return unanswered_.empty() ? SteadyTime::max() : unanswered_.begin()->second;
}

void Notes::noteAnswer(std::uint64_t number, const opcua::Answer<>& answer) {
    {
        const std::lock_guard lock(mutex_);
        unanswered_.erase(number);
    }
    // A stream that ended meanwhile refuses; its transition has the reason.
    if (answer || answer.error().status == opcua::status::kBadInvalidState) {
        return;
    }
    if (answer.error().code == Errc::connection_lost || answer.error().code == Errc::timeout) {
        noteBroken(answer.error().message);
        return;
    }
    note([&](Observed& seen) { seen.refused = answer.error().message; });
}

void Notes::noteSafety(device::SafetyState safety) {
    note([&](Observed& seen) {
        if (seen.safety != safety) {
            seen.safety = safety;
            seen.safety_since = std::chrono::steady_clock::now();
        }
    });
}

void Notes::noteCommanded(skill::State state) {
    note([&](Observed& seen) {
        ++commands_;
        enter(seen, state);
    });
}

std::uint64_t Notes::commands() const {
    const std::lock_guard lock(mutex_);
    return commands_;
}

void Notes::noteSkill(skill::State state, std::uint64_t commands) {
    note([&](Observed& seen) {
        if (commands == commands_) {
            enter(seen, state);
        }
    });
}

}  // namespace metier::client
