#include "joint_bus.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace metier::virtual_edo {
namespace {

constexpr int kLatencyCycles = 20;
constexpr int kPulseCycles = 30;

// Dead time between a target and the axis.
constexpr std::size_t kDelayCycles = 1;
// Factor by which an axis can exceed its limit to catch up with late set-points.
constexpr double kReserve = 1.25;
// An axis so far behind opens its power stage [deg].
constexpr double kFollowingError = 2.0;
// A target so far outside the stroke opens it too [deg].
constexpr double kOutside = 0.5;
// The current of a joint that holds [A].
constexpr double kHoldingCurrent = 0.15;

constexpr std::uint16_t kAcknowledgeBits = 0x000F;

std::uint16_t bit(JointFlag flag) {
    return static_cast<std::uint16_t>(1U << static_cast<unsigned>(flag));
}

device::JointArray arrayOf(const AxisValues& values) {
    return device::JointArray(values);
}

}  // namespace

JointBus::JointBus(const AxisLimits& limits, std::size_t axes, const AxisValues& position)
    : limits_(limits),
      axes_(axes),
      position_(position),
      target_(position),
      lag_(kDelayCycles, 0.0, kCycleSeconds) {
    hold();
}

void JointBus::hold() {
    target_ = position_;
    lag_.reset(arrayOf(position_));
}

void JointBus::discover(std::uint64_t mask) {
    // The joints of the mask are known at once; they acknowledge later.
    const auto count = static_cast<std::size_t>(std::bit_width(mask & maskOf(axes_)));
    if (joints_.size() != count && count > 0) {
        connect(mask & maskOf(axes_));
    }
    enqueue(Acknowledge::init, mask);
}

void JointBus::connect(std::uint64_t mask) {
    joints_.assign(static_cast<std::size_t>(std::bit_width(mask)), {});
    for (std::size_t axis = 0; axis < joints_.size(); ++axis) {
        joints_[axis].position = position_[axis];
        if (axis != kGripper) {
            joints_[axis].flags = bit(JointFlag::uncalibrated) | bit(JointFlag::power_stage_open);
        }
    }
    hold();
}

void JointBus::makeReady() {
    connect(maskOf(axes_));
    for (auto& joint : joints_) {
        joint.flags = 0;
        joint.current = kHoldingCurrent;
    }
}

void JointBus::enqueue(Acknowledge kind, std::uint64_t mask) {
    commands_.push_back({.kind = kind, .mask = mask, .due = kLatencyCycles});
}

void JointBus::perform(const Command& command) {
    for (std::size_t axis = 0; axis < joints_.size(); ++axis) {
        if (!inMask(command.mask, axis)) {
            continue;
        }
        auto& joint = joints_[axis];
        joint.flags = static_cast<std::uint16_t>((joint.flags & ~kAcknowledgeBits) |
                                                 static_cast<unsigned>(command.kind));
        pulse_left_ = kPulseCycles;
        if (command.kind == Acknowledge::reset && !emergency_stop_) {
            // A joint that starts again has forgotten why it stopped.
            joint.flags &=
                static_cast<std::uint16_t>(kAcknowledgeBits | bit(JointFlag::uncalibrated));
            joint.current = kHoldingCurrent;
        }
        if (command.kind == Acknowledge::calibration && axis != kGripper) {
            joint.flags &= static_cast<std::uint16_t>(~bit(JointFlag::uncalibrated));
            offset_[axis] += position_[axis];
            position_[axis] = 0.0;
            just_calibrated_ = true;
        }
    }
    if (command.kind == Acknowledge::reset || command.kind == Acknowledge::calibration) {
        hold();
    }
}

void JointBus::command(const std::vector<double>& position) {
    if (position.size() != joints_.size()) {
        return;
    }
    std::copy(position.begin(), position.end(), target_.begin());
}

bool JointBus::isBraked() const {
    return std::any_of(joints_.begin(), joints_.end(), [](const JointReport& joint) {
        return joint.has(JointFlag::power_stage_open);
    });
}

void JointBus::brake() {
    for (std::size_t axis = 0; axis < std::min(joints_.size(), kArmAxes); ++axis) {
        setFlag(axis, JointFlag::power_stage_open);
        joints_[axis].current = 0.0;
    }
    hold();
}

void JointBus::pressEmergencyStop() {
    emergency_stop_ = true;
    brake();
}

void JointBus::setFlag(std::size_t axis, JointFlag flag) {
    if (axis < joints_.size()) {
        joints_[axis].flags |= bit(flag);
    }
}

void JointBus::step(std::optional<double> part_width) {
    just_calibrated_ = false;
    if (pulse_left_ > 0 && --pulse_left_ == 0) {
        for (auto& joint : joints_) {
            joint.flags &= static_cast<std::uint16_t>(~kAcknowledgeBits);
        }
    }
    for (auto& command : commands_) {
        --command.due;
    }
    while (!commands_.empty() && commands_.front().due <= 0) {
        perform(commands_.front());
        commands_.pop_front();
    }
    lag_.advance(arrayOf(target_));
    const auto delayed = lag_.position();
    const bool braked = isBraked() || joints_.empty();
    for (std::size_t axis = 0; axis < kMostAxes; ++axis) {
        follow(axis, braked ? position_[axis] : delayed[axis], part_width);
    }
    if (isBraked() && !braked) {
        brake();
    }
}

void JointBus::follow(std::size_t axis, double target, std::optional<double> part_width) {
    const auto& limit = limits_[axis];
    const double furthest = limit.velocity * kReserve * kCycleSeconds;
    double next = position_[axis] + std::clamp(target - position_[axis], -furthest, furthest);
    if (axis == kGripper) {
        next = stopAtPart(position_[axis], std::clamp(next, limit.lower, limit.upper), part_width);
    }
    const double velocity = (next - position_[axis]) / kCycleSeconds;
    position_[axis] = next;
    if (axis < joints_.size() && !inMask(silent_, axis)) {
        joints_[axis].position = next;
        joints_[axis].velocity = velocity;
    }
    if (axis < std::min(kArmAxes, joints_.size())) {
        check(axis, target);
    }
}

double JointBus::stopAtPart(double position, double next, std::optional<double> part_width) {
    constexpr double kTouch = 1e-6;
    const bool blocked = part_width && next <= *part_width && position >= *part_width - kTouch;
    grips_ = blocked && target_[kGripper] < *part_width;
    return blocked ? *part_width : next;
}

void JointBus::check(std::size_t axis, double target) {
    const auto& limit = limits_[axis];
    if (target < limit.lower - kOutside || target > limit.upper + kOutside) {
        setFlag(axis, JointFlag::stroke_end);
        setFlag(axis, JointFlag::power_stage_open);
    }
    if (std::abs(target - position_[axis]) > kFollowingError) {
        setFlag(axis, JointFlag::following_error);
        setFlag(axis, JointFlag::power_stage_open);
    }
}

std::optional<BusReport> JointBus::report() const {
    if (bus_silent_) {
        return std::nullopt;
    }
    return BusReport{.mask = maskOf(joints_.size()) & ~silent_, .joints = joints_};
}

AxisValues JointBus::truePosition() const {
    AxisValues position = position_;
    for (std::size_t axis = 0; axis < kMostAxes; ++axis) {
        position[axis] += offset_[axis];
    }
    return position;
}

}  // namespace metier::virtual_edo
