#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "path.hpp"
#include "servo.hpp"

namespace metier::virtual_iiwa {

/// Length of the cabinet's cycle [s].
inline constexpr double kCycleSeconds = 0.001;

/// The arm as the cabinet moves it, one cycle after the other.
///
/// Threading: one thread.
class Arm {
public:
    /// Plans a standard motion when the arm stands.
    using Plan = std::function<Planned(const motion::JointVector& start)>;
    enum class End : std::uint8_t { done, failed, cancelled };

    /// \param model outlives the arm
    Arm(const motion::RobotModel& model, const motion::JointVector& position);

    /// Brakes, then runs this motion. What moved before is cancelled.
    void move(Plan plan);
    /// Follows the target from now on; begins a servo motion if there is none of its kind.
    void servoTo(const motion::JointVector& target, const MotionLimits& limits);
    void servoTo(const MovingFrame& frame, const motion::Pose& base_from_tool,
                 const MotionLimits& limits);
    /// Brakes on its path; the motion ends so when the arm stands, at once if it had not begun.
    void brake(End end);
    /// Stands at once, without a motion.
    void halt();

    /// One cycle. \return how a motion ended, in the cycle in which it did
    std::optional<End> step();

    const motion::RobotModel& model() const noexcept { return *model_; }
    const motion::JointVector& position() const noexcept { return position_; }  ///< [rad]
    /// Over the last 10 ms [rad/s].
    motion::JointVector velocity() const noexcept;
    /// Reports whether a motion runs or is about to begin.
    bool moving() const noexcept { return path_ || servo_ || next_; }
    /// Reports whether a standard motion runs and does not brake.
    bool running() const noexcept { return path_ && !braking_; }

private:
    struct Run {
        std::unique_ptr<Path> path;
        motion::Profile profile;
        double time = 0.0;
    };
    using Moved = std::optional<End>;

    bool begin(const Plan& plan);
    Moved stepPath();
    Moved stepServo();
    bool follow(const std::optional<motion::JointVector>& wanted);
    void breakDown();
    Moved finish(End end);
    void clear();

    static constexpr std::size_t kHistory = 11;

    const motion::RobotModel* model_;
    motion::JointVector position_;
    std::array<motion::JointVector, kHistory> history_;
    std::size_t newest_ = 0;
    std::function<bool()> next_;  // begins a motion when the arm stands; false: it cannot
    std::optional<Run> path_;
    std::unique_ptr<Servo> servo_;
    JointServo* joint_servo_ = nullptr;    // servo_, if it is one
    LinearServo* linear_servo_ = nullptr;  // servo_, if it is one
    bool braking_ = false;
    End brake_end_ = End::cancelled;
    std::optional<End> never_begun_;  // end of a motion that had not begun
};

}  // namespace metier::virtual_iiwa
