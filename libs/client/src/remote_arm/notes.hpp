#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "metier/base/clock.hpp"
#include "metier/device/arm.hpp"
#include "metier/opcua/client.hpp"
#include "metier/skill/program_observer.hpp"
#include "metier/skill/state.hpp"
#include "remote_arm/wake_up.hpp"

namespace metier::client {

/// Values that the server of an arm published last.
struct Observed {
    device::JointArray position;     ///< measured [rad]; empty before the first
    SteadyTime sampled{};            ///< when `position` came
    SteadyTime moved{};              ///< when the measured arm was last seen in motion
    device::JointArray place{};      ///< where that was [rad]
    std::optional<bool> standstill;  ///< as the server judges; none if it does not publish it
    device::SafetyState safety = device::SafetyState::normal;
    SteadyTime safety_since{};  ///< when `safety` became what it is
    std::string words;          ///< the robot's own, of why the stream skill is Halted
    std::uint64_t missed_cycles = 0;
    /// End of the stream that was started last, of a server that names executions
    std::optional<skill::TransitionEvent> stream_end;
    /// State of the stream skill; none for a server that names executions: its events say it
    std::optional<skill::State> skill;
    SteadyTime skill_since{};  ///< when `skill` became what it is
    std::string refused;       ///< why a set-point was refused, since the stream was started
    std::string broken;        ///< why nothing more will come
};

/// Notes of the connection's thread for the owner of a session, which they wake.
///
/// Shared with callbacks and answers that are still under way when the session ends.
/// Threading: any thread.
class Notes {
public:
    explicit Notes(std::shared_ptr<WakeUp> wake_up) : wake_up_(std::move(wake_up)) {}

    Observed observed() const;

    template <typename Change>
    void note(Change change) {
        {
            const std::lock_guard lock(mutex_);
            change(observed_);
        }
        wake_up_->notify();
    }
    void notePosition(const device::JointArray& position);
    void noteBroken(const std::string& why);
    /// A set-point is about to be written. \return its number
    std::uint64_t noteWrite();
    /// \param number as noteWrite() gave it
    void noteAnswer(std::uint64_t number, const opcua::Answer<>& answer);
    /// When the oldest set-point that is not answered yet was written; the latest time if there is
    /// none.
    SteadyTime oldestUnanswered() const;
    void noteSafety(device::SafetyState safety);
    /// Notes the state of the skill that a command to it has brought about.
    void noteCommanded(skill::State state);
    /// Number of calls of noteCommanded().
    std::uint64_t commands() const;
    /// Notes the state that was read, unless a command was given since.
    /// \param commands their number before the state was asked for
    void noteSkill(skill::State state, std::uint64_t commands);

private:
    mutable std::mutex mutex_;
    Observed observed_;
    std::uint64_t commands_ = 0;
    std::uint64_t writes_ = 0;
    std::map<std::uint64_t, SteadyTime> unanswered_;
    const std::shared_ptr<WakeUp> wake_up_;  // of the owner, who may be gone
};

}  // namespace metier::client
