#pragma once

#include "commanded_motion.hpp"
#include "handover.hpp"
#include "metier/device/arm_core.hpp"
#include "metier/edo_driver/encoder.hpp"
#include "safety_keeper.hpp"

namespace metier::edo_driver {

/// Moves the arm by set-points: takes control when a source is attached, asks it once per cycle,
/// brakes, and gives control back at rest.
///
/// Threading: one thread, the cycle. On its normal path it does not allocate.
class ArmDrive {
public:
    /// All must outlive this.
    ArmDrive(const EdoOptions& options, device::ArmCore& core, SafetyKeeper& safety);

    /// A new connection to a robot of that generation. Control that was taken when the last one was
    /// lost is given back first.
    void connected(const Generation& generation) noexcept;
    /// Reports the loss of the link: the source that moves the arm is ended at once.
    void disconnected() noexcept;

    /// One cycle of the robot.
    void onJointStates(const JointStates& states, SteadyTime now, Wire& wire);
    void onResponse(const ServiceResponse& response, SteadyTime now);
    void onAlgorithmState(const AlgorithmState& state, SteadyTime now) noexcept;
    /// Notices what did not come. Also between cycles.
    void tick(SteadyTime now);

    /// Asks for control to be given back as soon as no source moves the arm, because another user
    /// wants the joints. Holds until the next call.
    enum class Wanted : std::uint8_t { for_sources, elsewhere };
    void setWanted(Wanted wanted) noexcept { wanted_ = wanted; }
    /// Gives back control that an earlier client has left taken, if there is any. Only while free.
    void giveBackLeftover(SteadyTime now, Wire& wire);
    /// Reports whether the robot's own trajectory generator has the joints.
    bool free() const noexcept { return handover_.state() == Handover::State::free; }
    /// Commanded position of the joints [rad], [m].
    JointSetPoint holding() const noexcept;

private:
    void measure(const JointStates& states, SteadyTime now) noexcept;
    void whileFree(SteadyTime now, Wire& wire);
    void whileTaken(SteadyTime now, Wire& wire);
    void move(device::SetPointSource* source) noexcept;
    void follow(device::SetPointSource& source) noexcept;
    void judgeFollowing(SteadyTime now) noexcept;
    void reportProblems();
    void endWhenDue(SteadyTime now) noexcept;
    void end(device::EndCause cause) noexcept;
    void giveBackWhenDue(SteadyTime now, Wire& wire);
    bool atRest() const noexcept;
    bool normal() const noexcept { return core_.safetyState() == device::SafetyState::normal; }

    const EdoOptions& options_;
    device::ArmCore& core_;
    SafetyKeeper& safety_;
    Handover handover_;
    SetPointText text_;
    CommandedMotion command_;
    FollowingWatch watch_;
    Pacer pacer_{EdoOptions::kCycle};
    device::ArmState state_;
    double gripper_ = 0.0;  // held while control is taken [m]
    double measured_gripper_ = 0.0;
    Wanted wanted_ = Wanted::for_sources;
    bool leftover_ = false;
    int cycles_at_rest_ = 0;
    SteadyTime last_cycle_{};
    std::optional<SteadyTime> stopping_since_{};
    // Found by the cycle, put into words behind it.
    std::optional<Violation> violation_;
    std::optional<FollowingWatch::Lag> lag_;
};

}  // namespace metier::edo_driver
