#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "metier/motion/profile.hpp"
#include "path.hpp"

namespace metier::virtual_iiwa {

/// Follows a target in several dimensions, each as quick as it may; a new target takes over from
/// the motion that is under way.
class Follower {
public:
    static constexpr std::size_t kMostDimensions = 7;
    using Values = std::array<double, kMostDimensions>;

    Follower() = default;
    using States = std::array<motion::ScalarState, kMostDimensions>;
    using Limits = std::array<motion::ScalarLimits, kMostDimensions>;
    /// Comes to rest from these states.
    Follower(const States& start, const Limits& limits);

    void follow(const Values& target) noexcept;
    void brake() noexcept;
    void step(double seconds) noexcept { time_ += seconds; }
    Values values() const noexcept;
    /// Time since all dimensions stand [s]; negative before.
    double standing() const noexcept;

private:
    Limits limits_{};
    std::array<motion::Profile, kMostDimensions> profiles_{};
    double time_ = 0.0;
};

/// The servo motion: each set-point only changes its target.
class Servo {
public:
    virtual ~Servo() = default;
    void brake() noexcept { follower_.brake(); }
    double standing() const noexcept { return follower_.standing(); }
    /// The joint position so much later [rad]; nothing where the arm cannot be.
    std::optional<motion::JointVector> step(double seconds, const motion::JointVector& near) {
        follower_.step(seconds);
        return position(near);
    }

protected:
    virtual std::optional<motion::JointVector> position(const motion::JointVector& near) const = 0;
    Follower follower_;
};

/// Follows joint positions with the axes' shares.
class JointServo final : public Servo {
public:
    /// \param velocity at the start [rad/s]; it comes to rest if no target follows
    JointServo(const motion::RobotModel& model, const motion::JointVector& start,
               const motion::JointVector& velocity, const MotionLimits& limits);
    void follow(const motion::JointVector& target) noexcept;

private:
    std::optional<motion::JointVector> position(const motion::JointVector& near) const override;

    std::size_t axis_count_;
};

/// Follows poses of a tool frame, position and rotation by themselves.
class LinearServo final : public Servo {
public:
    LinearServo(const MovingFrame& frame, const motion::JointVector& start,
                const MotionLimits& limits);
    void follow(const motion::Pose& base_from_tool) noexcept;

private:
    std::optional<motion::JointVector> position(const motion::JointVector& near) const override;

    MovingFrame frame_;
    Eigen::Quaterniond start_rotation_;  // the follower's rotation is from here
    double redundancy_angle_;
};

}  // namespace metier::virtual_iiwa
