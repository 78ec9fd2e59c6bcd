#pragma once

#include <optional>

#include "metier/device/gripper.hpp"
#include "metier/edo_driver/encoder.hpp"
#include "options.hpp"
#include "wire.hpp"

namespace metier::edo_driver {

/// One motion of the jaws.
struct GripperTask {
    enum class Kind : std::uint8_t { grasp, release, move };

    Kind kind = Kind::move;
    double target = 0.0;  ///< distance between the jaws [m]
    int override_percent = 100;
};

/// Checks a request and makes a task of it.
/// Errors: out_of_range, invalid_argument (no width to move to), not_supported (force: the e.DO's
///         gripper has no force control).
Result<GripperTask> taskFor(GripperTask::Kind kind, const device::GripperRequest& request,
                            const GripperOptions& options);

/// Moves the jaws by motions that the robot plans itself: the gripper is its last joint.
///
/// The robot drops a motion that its state does not allow without a word, and "executed" only means
/// that the set-points are through. So a motion began when the machine state or the jaws say so,
/// and where it ended is what the joint says.
///
/// Threading: one thread.
class GripperDrive {
public:
    /// \param options must outlive this
    explicit GripperDrive(const EdoOptions& options) : options_(options) {}

    bool running() const noexcept { return step_ != Step::idle; }
    /// \param holding where all joints are held; the axes stay there
    void start(const GripperTask& task, const JointSetPoint& holding, SteadyTime now, Wire& wire);
    void stop(SteadyTime now, Wire& wire);
    void abandon() noexcept { step_ = Step::idle; }

    void onFeedback(const MovementFeedback& feedback);
    void onJoint(const JointSample& jaws, SteadyTime now) noexcept;
    /// Goes on. \return how the motion ended, once
    std::optional<Result<device::GripperOutcome>> tick(const MachineState& machine, SteadyTime now,
                                                       Wire& wire);

    double width() const noexcept { return width_; }  ///< [m]
    bool moving() const noexcept { return !resting_; }
    bool partHeld() const noexcept { return held_at_.has_value(); }

private:
    enum class Step : std::uint8_t { idle, sent, moving, cancelling };
    using Ended = std::optional<Result<device::GripperOutcome>>;

    Ended tickSent(const MachineState& machine, SteadyTime now);
    Ended tickMoving(const MachineState& machine, SteadyTime now, Wire& wire);
    Ended tickCancelling(const MachineState& machine, SteadyTime now);
    Result<device::GripperOutcome> judge();
    bool restingFor(Duration duration, SteadyTime now) const noexcept;
    Ended failed(Errc code, const std::string& why);

    const EdoOptions& options_;
    Step step_ = Step::idle;
    GripperTask task_;
    double start_width_ = 0.0;
    SteadyTime deadline_{};  // deadline of the whole motion
    SteadyTime begin_by_{};
    bool executed_ = false;
    std::string rejection_;

    double width_ = 0.0;
    double current_ = 0.0;
    bool resting_ = true;
    SteadyTime resting_since_{};
    std::optional<double> held_at_{};  // [m]
};

}  // namespace metier::edo_driver
