#include "servo.hpp"

#include <algorithm>

#include "metier/motion/rotation.hpp"

namespace metier::virtual_iiwa {

namespace {

using motion::JointVector;
using motion::Pose;
using motion::ScalarLimits;

// Limits for a dimension that does not exist.
constexpr ScalarLimits kUnused{1.0, 1.0, 1.0};
// The cabinet's own limits of a Cartesian servo motion's jerk [m/s3].
constexpr double kServoJerk = 100.0;

}  // namespace

Follower::Follower(const States& start, const Limits& limits) : limits_(limits) {
    for (std::size_t i = 0; i < kMostDimensions; ++i) {
        profiles_[i] = motion::Profile::brake(start[i], limits_[i]);
    }
}

void Follower::follow(const Values& target) noexcept {
    for (std::size_t i = 0; i < kMostDimensions; ++i) {
        profiles_[i] = motion::Profile::toRest(profiles_[i].at(time_), target[i], limits_[i]);
    }
    time_ = 0.0;
}

void Follower::brake() noexcept {
    for (std::size_t i = 0; i < kMostDimensions; ++i) {
        profiles_[i] = motion::Profile::brake(profiles_[i].at(time_), limits_[i]);
    }
    time_ = 0.0;
}

Follower::Values Follower::values() const noexcept {
    Values values{};
    for (std::size_t i = 0; i < kMostDimensions; ++i) {
        values[i] = profiles_[i].at(time_).position;
    }
    return values;
}

double Follower::standing() const noexcept {
    double longest = 0.0;
    for (const auto& profile : profiles_) {
        longest = std::max(longest, profile.duration());
    }
    return time_ - longest;
}

// ---- joints ------------------------------------------------------------------------------------

JointServo::JointServo(const motion::RobotModel& model, const JointVector& start,
                       const JointVector& velocity, const MotionLimits& limits)
    : axis_count_(start.size()) {
    Follower::Limits axes{};
    axes.fill(kUnused);
    Follower::States states{};
    for (std::size_t axis = 0; axis < start.size(); ++axis) {
        axes[axis] = axisLimits(model, axis, limits);
        states[axis] = {start[axis], velocity[axis], 0.0};
    }
    follower_ = Follower(states, axes);
}

void JointServo::follow(const JointVector& target) noexcept {
    Follower::Values values{};
    std::copy(target.begin(), target.end(), values.begin());
    follower_.follow(values);
}

std::optional<JointVector> JointServo::position(const JointVector&) const {
    const auto values = follower_.values();
    JointVector joints(axis_count_);
    std::copy_n(values.begin(), axis_count_, joints.begin());
    return joints;
}

// ---- poses -------------------------------------------------------------------------------------

LinearServo::LinearServo(const MovingFrame& frame, const JointVector& start,
                         const MotionLimits& limits)
    : frame_(frame), redundancy_angle_(frame.model->kinematics().redundancyAngle(start)) {
    const Pose from = frame.model->kinematics().forward(start) * frame.flange_from_tool;
    start_rotation_ = from.rotation;
    const auto& turning = frame.model->cartesianLimits();
    const ScalarLimits translation{limits.velocity, limits.acceleration, kServoJerk};
    const ScalarLimits rotation{turning.angular_velocity, turning.angular_acceleration,
                                turning.angular_jerk};
    const auto& at = from.translation;
    follower_ = Follower(
        {motion::ScalarState{at.x()}, motion::ScalarState{at.y()}, motion::ScalarState{at.z()}},
        {translation, translation, translation, rotation, rotation, rotation, kUnused});
}

void LinearServo::follow(const Pose& base_from_tool) noexcept {
    const auto& at = base_from_tool.translation;
    const Eigen::Vector3d turn =
        motion::rotationVectorBetween(start_rotation_, base_from_tool.rotation);
    follower_.follow({at.x(), at.y(), at.z(), turn.x(), turn.y(), turn.z()});
}

std::optional<JointVector> LinearServo::position(const JointVector& near) const {
    const auto v = follower_.values();
    const Pose base_from_tool{{v[0], v[1], v[2]},
                              motion::fromRotationVector({v[3], v[4], v[5]}) * start_rotation_};
    const auto& kinematics = frame_.model->kinematics();
    const auto found = kinematics.solutionNear(base_from_tool * frame_.flange_from_tool.inverse(),
                                               near, redundancy_angle_);
    if (found.empty() || !kinematics.withinLimits(found)) {
        return std::nullopt;
    }
    return found;
}

}  // namespace metier::virtual_iiwa
