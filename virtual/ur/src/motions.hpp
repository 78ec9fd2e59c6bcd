#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <optional>

#include "metier/motion/kinematics.hpp"
#include "metier/motion/pose.hpp"
#include "robot_state.hpp"

namespace metier::virtual_ur {

/// Position and velocity of the commanded arm.
struct JointState {
    Vector6 position{};  ///< [rad]
    Vector6 velocity{};  ///< [rad/s]
};

/// One of the controller's ways to move: gives a set-point per cycle.
///
/// Threading: one thread, the cycle.
class Motion {
public:
    virtual ~Motion() = default;
    /// The next set-point [rad]; empty if there is none (a line through a singular place).
    /// \param now  the last set-point and its velocity
    /// \param step [s] that pass
    virtual std::optional<Vector6> next(const JointState& now, double step) = 0;
    /// Reports whether a script that waits for the motion may go on. The motion itself may go on,
    /// too.
    virtual bool done() const = 0;
};

/// Kinematics of the arm with its tool.
struct ToolKinematics {
    const motion::Kinematics& arm;
    motion::Pose flange_from_tool;
};

/// Speed and acceleration of a move along its path.
struct PathSpeed {
    double velocity = 0.0;
    double acceleration = 0.0;
    double duration = 0.0;  ///< [s]; > 0: as long as that instead
};

/// Follows a set-point that changes all the time: two equal low-passes, which together lag behind
/// it by lookahead + 1 / gain (see the README on simulated parts).
class ServoMotion final : public Motion {
public:
    /// \param now where the arm is and how fast: the motion goes on from there
    explicit ServoMotion(const JointState& now);
    /// Sets the target from now on.
    /// \param duration [s] that a script waits for it
    /// \param lag      [s], > 0
    void retarget(const Vector6& target, double duration, double lag);

    std::optional<Vector6> next(const JointState& now, double step) override;
    bool done() const override { return left_ <= 0.0; }

private:
    JointState start_;
    Vector6 target_{};
    std::optional<Vector6> first_;  // output of the first low-pass
    double lag_ = 0.1;
    double left_ = 0.0;
};

/// Drives the tool along a line towards a pose that may change all the time, and rests there.
class LineServo final : public Motion {
public:
    /// \param now where the arm is and how fast: the motion goes on from there
    explicit LineServo(const JointState& now) : start_velocity_(now.velocity) {}
    /// Sets the target from now on.
    /// \param speed velocity [m/s] and acceleration [m/s2] of the tool's origin, > 0; a turn counts
    ///              as the way of a point kTurnRadius beside it. The duration has no meaning.
    void retarget(const motion::Pose& base_from_target, const PathSpeed& speed,
                  const ToolKinematics& tool);

    static constexpr double kTurnRadius = 0.1;  ///< [m]; the controller reports it, too

    std::optional<Vector6> next(const JointState& now, double step) override;
    /// A script waits for one cycle.
    bool done() const override { return waited_; }

private:
    using Twist = Eigen::Matrix<double, 6, 1>;
    Twist wanted(const Twist& way, double step) const;

    Vector6 start_velocity_;
    std::optional<ToolKinematics> tool_;
    motion::Pose base_from_target_;
    PathSpeed speed_;
    std::optional<Twist> twist_;  // base frame [m/s]; its turn times kTurnRadius
    bool waited_ = false;
};

/// Reaches a joint velocity with an acceleration of the leading axis, and keeps it.
/// \param duration [s]; 0: done when the velocity is reached
std::unique_ptr<Motion> speedJ(const Vector6& velocity, double acceleration, double duration);
/// The same for the tool: twist in the base frame.
std::unique_ptr<Motion> speedL(const Vector6& twist, double acceleration, double duration,
                               const ToolKinematics& tool);
/// Brakes every axis along its direction until the arm stands.
std::unique_ptr<Motion> stopJ(double acceleration);

/// Move from standstill on which all axes arrive together. Speeds [rad/s] are those of the leading
/// axis.
std::unique_ptr<Motion> moveJ(const Vector6& start, const Vector6& target, const PathSpeed& speed);
/// Move from standstill of the tool along a line. Speeds in [m/s]; for a rotation without a way in
/// [rad/s].
std::unique_ptr<Motion> moveL(const Vector6& start, const motion::Pose& base_from_target,
                              const PathSpeed& speed, const ToolKinematics& tool);

/// base_from_pose of x, y, z and a rotation vector, and back.
motion::Pose toPose(const Vector6& pose);
Vector6 toVector(const motion::Pose& pose);
motion::JointVector toJointVector(const Vector6& q);

/// Six values of a list of another kind.
template <typename List>
Vector6 toVector6(const List& values) {
    Vector6 result{};
    std::copy_n(values.begin(), kAxes, result.begin());
    return result;
}

/// Largest absolute value.
double largest(const Vector6& values);

}  // namespace metier::virtual_ur
