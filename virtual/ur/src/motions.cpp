#include "motions.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>

#include "metier/motion/rotation.hpp"
#include "metier/virtual_controller/trapezoid.hpp"

namespace metier::virtual_ur {

namespace {

using virtual_controller::Trapezoid;

// Damping of the inverse Jacobian: keeps it finite in a singular place.
constexpr double kDamping = 1e-6;
// A servo that is so near is there: an exponential alone would never arrive [rad].
constexpr double kArrived = 1e-9;
// A tool that is so near is there [m].
constexpr double kThere = 1e-9;
// A shorter line is a turn on the spot [m].
constexpr double kOnTheSpot = 1e-6;

// A duration is over when less of it is left than this: sums of steps are not exact [s].
constexpr double kRounding = 1e-6;

/// A path with these speeds. A time counts alone: a client may leave the speeds zero.
Trapezoid profileOf(double length, const PathSpeed& speed) {
    const Trapezoid fastest(length, std::max(speed.velocity, 1e-9),
                            std::max(speed.acceleration, 1e-9));
    return speed.duration > 0.0 ? fastest.lasting(speed.duration) : fastest;
}

/// The values of `function` for each axis.
template <typename Function>
Vector6 combined(const Vector6& left, const Vector6& right, Function function) {
    Vector6 result{};
    std::transform(left.begin(), left.end(), right.begin(), result.begin(), function);
    return result;
}

/// Changes every axis' velocity towards a target so that all reach it at the same time.
Vector6 approach(const Vector6& from, const Vector6& to, double change) {
    const auto way = combined(to, from, std::minus<>());
    const double leading = largest(way);
    if (leading <= change) {
        return to;
    }
    return combined(from, way,
                    [share = change / leading](double f, double w) { return f + share * w; });
}

Vector6 moved(const Vector6& position, const Vector6& velocity, double step) {
    return combined(position, velocity, [step](double p, double v) { return p + v * step; });
}

class SpeedJ final : public Motion {
public:
    SpeedJ(const Vector6& velocity, double acceleration, double duration)
        : velocity_(velocity),
          acceleration_(acceleration),
          timed_(duration > 0.0),
          left_(duration) {}

    std::optional<Vector6> next(const JointState& now, double step) override {
        // Not now.velocity: while time is scaled that is another one.
        present_ = approach(present_.value_or(now.velocity), velocity_, acceleration_ * step);
        left_ -= step;
        return moved(now.position, *present_, step);
    }
    bool done() const override { return timed_ ? left_ < kRounding : present_ == velocity_; }

private:
    Vector6 velocity_;
    std::optional<Vector6> present_;
    double acceleration_;
    bool timed_;
    double left_;
};

using Twist = Eigen::Matrix<double, 6, 1>;

// However hard a script asks the tool to accelerate, its joints do not do more [rad/s2]; believed.
constexpr double kTwistRamp = 20.0;

/// Jacobian of the tool's origin, in the base frame.
Eigen::Matrix<double, 6, 6> toolJacobian(const ToolKinematics& tool, const motion::JointVector& q) {
    Eigen::Matrix<double, 6, 6> jacobian = tool.arm.jacobian(q);
    const Eigen::Vector3d arm = tool.arm.forward(q).rotation * tool.flange_from_tool.translation;
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
        const Eigen::Vector3d turn = jacobian.block<3, 1>(3, axis);
        jacobian.block<3, 1>(0, axis) += turn.cross(arm);
    }
    return jacobian;
}

/// Axes near `near` that put the tool there; empty if there are none.
std::optional<Vector6> axesAt(const ToolKinematics& tool, const motion::Pose& base_from_tool,
                              const Vector6& near) {
    const auto solution = tool.arm.solutionNear(base_from_tool * tool.flange_from_tool.inverse(),
                                                toJointVector(near), 0.0);
    if (solution.size() != kAxes) {
        return std::nullopt;
    }
    return toVector6(solution);
}

class SpeedL final : public Motion {
public:
    struct Wanted {
        Twist twist;
        double acceleration = 0.0;
        double duration = 0.0;
    };
    SpeedL(const Wanted& wanted, const ToolKinematics& tool)
        : wanted_(wanted), left_(wanted.duration), tool_(tool) {}

    std::optional<Vector6> next(const JointState& now, double step) override {
        const auto jacobian = toolJacobian(tool_, toJointVector(now.position));
        if (!twist_) {
            twist_ = jacobian * Eigen::Map<const Twist>(now.velocity.data());
        }
        const Twist way = wanted_.twist - *twist_;
        const double change = wanted_.acceleration * step;
        reached_ = way.norm() <= change;
        *twist_ = reached_ ? wanted_.twist : Twist(*twist_ + way * (change / way.norm()));
        left_ -= step;
        Vector6 velocity{};
        const Eigen::Matrix<double, 6, 6> square =
            jacobian * jacobian.transpose() + kDamping * Eigen::Matrix<double, 6, 6>::Identity();
        Eigen::Map<Twist>(velocity.data()) = jacobian.transpose() * square.ldlt().solve(*twist_);
        present_ = approach(present_.value_or(now.velocity), velocity, kTwistRamp * step);
        reached_ = reached_ && present_ == velocity;
        return moved(now.position, *present_, step);
    }
    bool done() const override { return wanted_.duration > 0.0 ? left_ < kRounding : reached_; }

private:
    Wanted wanted_;
    double left_;
    ToolKinematics tool_;
    std::optional<Twist> twist_;
    std::optional<Vector6> present_;  // joint velocity [rad/s]
    bool reached_ = false;
};

class MoveJ final : public Motion {
public:
    MoveJ(const Vector6& start, const Vector6& target, const PathSpeed& speed)
        : start_(start),
          target_(target),
          length_(largest(combined(target, start, std::minus<>()))),
          profile_(profileOf(length_, speed)) {}

    std::optional<Vector6> next(const JointState&, double step) override {
        time_ += step;
        if (done()) {
            return target_;
        }
        const double share = profile_.at(time_) / length_;
        return combined(start_, target_,
                        [share](double from, double to) { return from + share * (to - from); });
    }
    bool done() const override { return time_ >= profile_.duration() - kRounding; }

private:
    Vector6 start_;
    Vector6 target_;
    double length_;
    Trapezoid profile_;
    double time_ = 0.0;
};

class MoveL final : public Motion {
public:
    struct Line {
        motion::Pose start;
        motion::Pose target;
        double length = 0.0;
    };
    MoveL(const Line& line, const PathSpeed& speed, const ToolKinematics& tool)
        : line_(line), profile_(profileOf(line.length, speed)), tool_(tool) {}

    std::optional<Vector6> next(const JointState& now, double step) override {
        time_ += step;
        const double share =
            line_.length > 0.0 && !done() ? profile_.at(time_) / line_.length : 1.0;
        const auto& start = line_.start;
        const motion::Pose base_from_tool{
            start.translation + share * (line_.target.translation - start.translation),
            motion::slerp(start.rotation, line_.target.rotation, share)};
        return axesAt(tool_, base_from_tool, now.position);
    }
    bool done() const override { return time_ >= profile_.duration() - kRounding; }

private:
    Line line_;
    Trapezoid profile_;
    ToolKinematics tool_;
    double time_ = 0.0;
};

}  // namespace

ServoMotion::ServoMotion(const JointState& now) : start_(now), target_(now.position) {}

void ServoMotion::retarget(const Vector6& target, double duration, double lag) {
    target_ = target;
    left_ = duration - kRounding;
    lag_ = lag;
}

std::optional<Vector6> ServoMotion::next(const JointState& now, double step) {
    left_ -= step;
    const double share = 1.0 - std::exp(-2.0 * step / lag_);
    if (!first_) {
        first_ = moved(start_.position, start_.velocity, step / share - step);
    }
    Vector6 result{};
    for (std::size_t i = 0; i < kAxes; ++i) {
        (*first_)[i] += share * (target_[i] - (*first_)[i]);
        result[i] = now.position[i] + share * ((*first_)[i] - now.position[i]);
        if (std::abs(target_[i] - result[i]) < kArrived) {
            result[i] = target_[i];
        }
    }
    return result;
}

void LineServo::retarget(const motion::Pose& base_from_target, const PathSpeed& speed,
                         const ToolKinematics& tool) {
    base_from_target_ = base_from_target;
    speed_ = speed;
    tool_.emplace(tool);
    waited_ = false;
}

LineServo::Twist LineServo::wanted(const Twist& way, double step) const {
    const double length = way.norm();
    if (length == 0.0) {
        return Twist::Zero();
    }
    // The most from which the tool can still stop at the target in whole steps.
    const double change = speed_.acceleration * step;
    const double stoppable =
        std::sqrt(2.0 * speed_.acceleration * length + 0.25 * change * change) - 0.5 * change;
    return way * (std::min({speed_.velocity, stoppable, length / step}) / length);
}

std::optional<Vector6> LineServo::next(const JointState& now, double step) {
    waited_ = true;
    const auto q = toJointVector(now.position);
    const auto base_from_tool = tool_->arm.forward(q) * tool_->flange_from_tool;
    if (!twist_) {
        twist_ = toolJacobian(*tool_, q) * Eigen::Map<const Twist>(start_velocity_.data());
        twist_->tail<3>() *= kTurnRadius;
    }
    Twist way;
    way << base_from_target_.translation - base_from_tool.translation,
        kTurnRadius *
            motion::rotationVectorBetween(base_from_tool.rotation, base_from_target_.rotation);
    const double most = speed_.acceleration * step;
    if (way.norm() < kThere && twist_->norm() <= most) {
        twist_->setZero();
        return now.position;
    }
    const Twist change = wanted(way, step) - *twist_;
    *twist_ += change.norm() > most ? Twist(change * (most / change.norm())) : change;
    const motion::Pose next{base_from_tool.translation + twist_->head<3>() * step,
                            motion::fromRotationVector(twist_->tail<3>() * (step / kTurnRadius)) *
                                base_from_tool.rotation};
    return axesAt(*tool_, next, now.position);
}

std::unique_ptr<Motion> speedJ(const Vector6& velocity, double acceleration, double duration) {
    return std::make_unique<SpeedJ>(velocity, acceleration, duration);
}

std::unique_ptr<Motion> speedL(const Vector6& twist, double acceleration, double duration,
                               const ToolKinematics& tool) {
    return std::make_unique<SpeedL>(SpeedL::Wanted{Twist(twist.data()), acceleration, duration},
                                    tool);
}

std::unique_ptr<Motion> stopJ(double acceleration) {
    return speedJ(Vector6{}, acceleration, 0.0);
}

std::unique_ptr<Motion> moveJ(const Vector6& start, const Vector6& target, const PathSpeed& speed) {
    return std::make_unique<MoveJ>(start, target, speed);
}

std::unique_ptr<Motion> moveL(const Vector6& start, const motion::Pose& base_from_target,
                              const PathSpeed& speed, const ToolKinematics& tool) {
    MoveL::Line line{tool.arm.forward(toJointVector(start)) * tool.flange_from_tool,
                     base_from_target};
    line.length = motion::distanceBetween(line.start, line.target);
    if (line.length < kOnTheSpot) {
        line.length = motion::rotationAngleBetween(line.start.rotation, line.target.rotation);
    }
    return std::make_unique<MoveL>(line, speed, tool);
}

double largest(const Vector6& values) {
    double result = 0.0;
    for (const double value : values) {
        result = std::max(result, std::abs(value));
    }
    return result;
}

motion::Pose toPose(const Vector6& pose) {
    return {Eigen::Vector3d(pose[0], pose[1], pose[2]),
            motion::fromRotationVector(Eigen::Vector3d(pose[3], pose[4], pose[5]))};
}

Vector6 toVector(const motion::Pose& pose) {
    const auto turn = motion::toRotationVector(pose.rotation);
    return {pose.translation.x(),
            pose.translation.y(),
            pose.translation.z(),
            turn.x(),
            turn.y(),
            turn.z()};
}

motion::JointVector toJointVector(const Vector6& q) {
    motion::JointVector result(kAxes);
    std::copy(q.begin(), q.end(), result.begin());
    return result;
}

}  // namespace metier::virtual_ur
