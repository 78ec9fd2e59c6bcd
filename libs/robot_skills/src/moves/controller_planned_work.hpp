#pragma once

#include <atomic>
#include <functional>
#include <memory>

#include "metier/device/motion_planner.hpp"
#include "metier/motion/trajectory.hpp"
#include "metier/robot_skills/move_parameters.hpp"
#include "moves/acceleration_phase.hpp"
#include "moves/arm_work.hpp"
#include "moves/move_skills.hpp"
#include "moves/move_variant.hpp"

namespace metier::robot_skills {

/// Notifies an execution of a motion that its controller has ended at the target or by a force.
using TellMove = std::function<void(const skill::ExecutionHandle&, const MoveResults&,
                                    const device::MotionOutcome&)>;

/// Calls tell.finish(), for moves without forces.
void tellMoveDone(const skill::ExecutionHandle& tell, const MoveResults& results,
                  const device::MotionOutcome& outcome);

/// One motion of a controller's own planner: what its caller and its controller share.
///
/// Threading: measured by the arm's cycle thread and ended by its notifying thread while it is in
/// motion; else the owner's thread has it.
class ControllerPlannedMove final : public device::MotionObserver {
public:
    struct Setup {
        MovedArm robot;
        motion::Trajectory trajectory;
        PathDeviationMeter::Path path;
        MoveEnd end;
        TellMove tell;
    };

    explicit ControllerPlannedMove(Setup setup);

    /// Owner's thread, before the controller is asked to move.
    void begin(const skill::ExecutionHandle& execution);
    /// Owner's thread, instead of ended(): the controller did not begin.
    void abandon() noexcept;
    /// Any thread.
    bool inMotion() const noexcept { return in_motion_.load(); }
    /// Notes that the motion is to be stopped. A stop without this note before it is an error.
    void stopAsked() noexcept { stop_asked_.store(true); }
    /// Owner's thread while not in motion: where it came to rest [rad].
    const device::JointArray& restingPlace() const noexcept { return rest_; }

    void observe(const device::ArmState& state) noexcept override;
    /// Notifying thread.
    void ended(const Result<device::MotionOutcome>& outcome);

private:
    void noteStop(const device::ArmState& state) noexcept;
    MoveResults results(const device::JointArray& reached) const;
    void tellArrived(const device::MotionOutcome& outcome);
    void tellStopped();

    Setup setup_;
    PathDeviationMeter deviation_;
    AccelerationPhase acceleration_;
    double place_ = 0.0;  ///< where the arm was last measured on the path, 0 start to 1 end
    std::atomic<bool> in_motion_{false};
    std::atomic<bool> stop_asked_{false};
    skill::ExecutionHandle tell_;
    device::JointArray rest_;
    SteadyTime begun_{};
    double first_begun_ = 0.0;                  ///< [s since 1970-01-01 UTC]
    double last_ended_ = 0.0;                   ///< as first_begun_
    std::chrono::duration<double> moved_{0.0};  ///< before the last begin()
};

/// An execution that lets the arm's controller plan and run the motion.
class ControllerPlannedWork final : public ArmWork {
public:
    /// \param planner that of the arm; must outlive the work
    /// \param motion  what `move` stands for
    ControllerPlannedWork(device::MotionPlanner& planner, device::ControllerPlannedMotion motion,
                          ControllerPlannedMove::Setup move);
    /// Stops the motion if it still runs.
    ~ControllerPlannedWork() override;
    ControllerPlannedWork(const ControllerPlannedWork&) = delete;
    ControllerPlannedWork& operator=(const ControllerPlannedWork&) = delete;

    void start(skill::ExecutionHandle execution) override;
    Result<void> suspend() override;
    Result<void> resume() override;
    void halt() override;
    void forceStop() noexcept override;

private:
    Result<void> move();

    device::MotionPlanner& planner_;
    device::ControllerPlannedMotion motion_;
    std::shared_ptr<ControllerPlannedMove> move_;  // shared with the controller while it moves
};

}  // namespace metier::robot_skills
