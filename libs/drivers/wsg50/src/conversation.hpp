#pragma once

#include <chrono>
#include <optional>
#include <set>

#include "metier/base/clock.hpp"
#include "metier/device/gripper.hpp"
#include "motion_task.hpp"
#include "observation.hpp"

namespace metier::wsg50_driver {

/// Options of a conversation: its first commands and its waiting times.
struct ConversationOptions {
    std::chrono::milliseconds update_period{20};  ///< update period of each of the four values
    int silence_periods = 3;    ///< without an update of a value: the gripper is lost
    double acceleration = 0.0;  ///< [m/s2]; 0: the gripper's own
    bool acknowledge = false;   ///< a fault that is there at the begin
    bool home = false;          ///< if it is not referenced; this moves the jaws
    std::chrono::milliseconds reply_timeout{1'000};
    std::chrono::milliseconds motion_timeout{30'000};
    std::chrono::milliseconds settle_timeout{300};
};

/// Listener to the findings of a conversation; called on its thread.
class ConversationListener : public CommandSink {
public:
    /// Called once, when the gripper has sent its limits.
    virtual void onLimits(const Limits& limits, double force_limit) = 0;
    /// After each update of a value; does not allocate.
    virtual void onState(const device::GripperState& state) = 0;
    /// After each change of state or text; never disconnected.
    virtual void onSafety(device::Safety safety) = 0;
    virtual void onMotionEnd(Result<device::GripperOutcome> outcome) = 0;
    virtual void onResetEnd(Result<void> outcome) = 0;
};

/// Dialogue with a gripper from the begin of a connection to its end: decides which command is sent
/// when, and interprets the replies. Knows neither sockets nor threads.
///
/// Threading: one thread. Taking an update neither allocates nor throws.
class Conversation {
public:
    /// Sends the first command.
    /// \param listener must outlive this
    Conversation(const ConversationOptions& options, SteadyTime now,
                 ConversationListener& listener);

    /// Takes a frame. Errors: the connection is to be ended; a reply makes no sense, or the gripper
    /// refused what the driver cannot do without.
    Result<void> take(const Frame& frame, SteadyTime now);
    /// Lets time pass. Errors: the gripper is silent.
    Result<void> tick(SteadyTime now);

    /// Begins a motion; its end is reported once. The safety must be normal and no motion under
    /// way.
    void begin(const Motion& motion, SteadyTime now);
    /// Stops the motion, if one is under way.
    void stop(SteadyTime now);
    /// Acknowledges a fault, and homes the gripper if it is not referenced; the end is reported
    /// once.
    void reset(SteadyTime now);

    /// Reports whether all commands of the begin were sent and answered.
    bool started() const noexcept { return started_; }
    /// Reports whether a motion may begin.
    bool ready() const noexcept {
        return started_ && !motion_ && safety_.state == device::SafetyState::normal;
    }

private:
    /// Steps of the begin, in their order.
    enum class Step : std::uint8_t {
        limits,
        force_limit,
        acceleration,
        system_state,
        grasping_state,
        width,
        force,
        done,
    };

    Result<void> takeStart(const Reply& reply, SteadyTime now);
    Result<void> takeStep(const Reply& reply);
    void nextStep(SteadyTime now);
    Command stepCommand() const;
    void started(SteadyTime now);

    void takeAnswer(const Reply& reply, SteadyTime now);
    bool settlesDebt(const Reply& reply);
    void follow(SteadyTime now);
    void endMotion(Result<device::GripperOutcome> outcome);
    void followReset(SteadyTime now);
    void endReset(Result<void> outcome);
    void tellSafety();
    device::Safety judgeSafety() const;

    ConversationOptions options_;
    ConversationListener& listener_;
    Observation seen_;
    device::Safety safety_{device::SafetyState::disconnected, {}, false};

    Step step_ = Step::limits;
    bool started_ = false;
    SteadyTime deadline_;  // deadline of the step
    Limits limits_;
    std::optional<double> force_limit_;

    std::optional<MotionTask> motion_;
    std::set<CommandId> owed_;  // last replies of motions that were given up

    bool resetting_ = false;
    std::optional<Observation::Mark> acknowledged_;  // waits for the state after it
    SteadyTime reset_deadline_;
};

}  // namespace metier::wsg50_driver
