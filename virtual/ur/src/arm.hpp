#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "metier/joint_simulator/guard.hpp"
#include "metier/joint_simulator/lag.hpp"
#include "metier/motion/robot_model.hpp"
#include "motions.hpp"
#include "robot_state.hpp"

namespace metier::virtual_ur {

/// Limits of the arm in the controller, and its way of stopping.
struct ArmOptions {
    std::vector<joint_simulator::AxisLimits> limits;  ///< six
    double cycle = 0.008;                             ///< [s]
    Vector6 start{};                                  ///< [rad]
    double stop_deceleration = 13.0;  ///< deceleration of the controller's own stop [rad/s2]
};

/// Why the controller has to stop the arm by itself.
struct ArmViolation {
    int code = 0;  ///< such as 150 for C150 of the maker's list of errors
    std::string text;
};

/// The arm without a robot: follows motions, judges each set-point, lags one cycle behind.
///
/// Threading: one thread, the cycle.
class Arm {
public:
    /// \param model of six axes; outlives the arm
    Arm(const motion::RobotModel& model, const ArmOptions& options);

    // Motions requested by a program; each replaces the motion before.
    void servo(const Vector6& target, double duration, double lag);
    /// The tool along a line; speeds as those of moveL().
    void servoLine(const motion::Pose& base_from_target, const PathSpeed& speed);
    void begin(std::unique_ptr<Motion> motion);
    /// A motion that begins at standstill: the arm is stopped first.
    using FromStandstill = std::function<std::unique_ptr<Motion>(const Vector6& start)>;
    void beginStanding(FromStandstill motion, double stop_acceleration);
    /// Reports whether a program that waits for the motion may go on.
    bool motionDone() const { return !motion_ || motion_->done(); }

    /// The controller's own stop, off the path; nothing else moves the arm until it stands.
    void brake();
    bool standing() const;

    /// One cycle.
    /// \param scaling of time along the motion, 0 to 1
    /// \return why the arm has to be stopped; its set-point was not taken then
    std::optional<ArmViolation> cycle(double scaling);
    /// Violation by a set-point of that axis beyond its upper limit.
    ArmViolation beyondLimit(std::size_t axis) const;
    bool withinLimits(const Vector6& position) const;
    /// Puts the arm elsewhere, standing.
    void reset(const Vector6& position);

    const JointState& target() const { return target_; }
    const Vector6& targetAcceleration() const { return acceleration_; }
    JointState actual() const;
    /// Measured position so many cycles ago; empty if that is too long ago.
    std::optional<Vector6> history(std::size_t cycles) const;

    ToolKinematics tool() const { return {model_.kinematics(), flange_from_tool_}; }
    void setTool(const motion::Pose& flange_from_tool) { flange_from_tool_ = flange_from_tool; }
    const motion::RobotModel& model() const { return model_; }

private:
    void forget();
    std::optional<ArmViolation> follow(double step);
    void take(const Vector6& position);

    const motion::RobotModel& model_;
    const ArmOptions options_;
    joint_simulator::Guard guard_;
    joint_simulator::Lag lag_;
    motion::Pose flange_from_tool_;
    JointState target_;
    Vector6 acceleration_{};
    std::unique_ptr<Motion> motion_;
    ServoMotion* servo_ = nullptr;     // the motion, if it is one
    LineServo* line_servo_ = nullptr;  // the motion, if it is one
    bool braking_ = false;
    std::deque<Vector6> history_;  // newest first
};

}  // namespace metier::virtual_ur
