#include "commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>

#include "metier/base/numbers.hpp"

namespace metier::iiwa_driver {

namespace {

constexpr double kNotWatched = std::numeric_limits<double>::quiet_NaN();
// Arguments of the codes 304 and 305.
constexpr double kPositionControl = 41;
constexpr double kAsynchronous = 51;

Command single(Code code, double argument) noexcept {
    Command command{code, {}};
    command.arguments[0] = argument;
    return command;
}

using Name = std::pair<Code, std::string_view>;
constexpr std::array kNames{Name{Code::state, "state"},
                            Name{Code::cancel, "cancel"},
                            Name{Code::move_joints, "joint move"},
                            Name{Code::move_pose, "Cartesian move"},
                            Name{Code::joint_velocity, "joint velocity"},
                            Name{Code::joint_acceleration, "joint acceleration"},
                            Name{Code::line_velocity, "Cartesian velocity"},
                            Name{Code::line_acceleration, "Cartesian acceleration"},
                            Name{Code::force_condition, "force condition"},
                            Name{Code::interface, "control interface"},
                            Name{Code::motion_type, "motion type"},
                            Name{Code::control_mode, "control mode"},
                            Name{Code::execution, "execution type"},
                            Name{Code::tool, "tool"}};

}  // namespace

Command askState() noexcept {
    return {};
}

Command cancel() noexcept {
    return {Code::cancel, {}};
}

Command moveJoints(const device::JointArray& target) noexcept {
    Command command{Code::move_joints, {}};
    std::copy_n(target.begin(), std::min(target.size(), kAxes), command.arguments.begin());
    return command;
}

Command movePose(const Frame& target) noexcept {
    return {Code::move_pose,
            {target.x * kMillimetresPerMetre, target.y * kMillimetresPerMetre,
             target.z * kMillimetresPerMetre, target.c, target.b, target.a, 0.0}};
}

Command jointVelocity(double share) noexcept {
    return single(Code::joint_velocity, share);
}

Command jointAcceleration(double share) noexcept {
    return single(Code::joint_acceleration, share);
}

Command lineVelocity(double velocity) noexcept {
    return single(Code::line_velocity, velocity * kMillimetresPerMetre);
}

Command lineAcceleration(double acceleration) noexcept {
    return single(Code::line_acceleration, acceleration * kMillimetresPerMetre);
}

Command forceCondition(const device::ForceCondition& condition, double tolerance) noexcept {
    Command command{Code::force_condition, {}};
    for (std::size_t axis = 0; axis < condition.force.size(); ++axis) {
        const auto& limit = condition.force[axis];
        command.arguments[axis] = limit.value_or(kNotWatched);
        command.arguments[axis + 3] = limit ? tolerance : kNotWatched;
    }
    return command;
}

Command forceConditionOff() noexcept {
    return forceCondition({}, kNotWatched);
}

Command chooseInterface(Interface interface) noexcept {
    return single(Code::interface, static_cast<double>(interface));
}

Command chooseMotionType(MotionType type) noexcept {
    return single(Code::motion_type, static_cast<double>(type));
}

Command positionControl() noexcept {
    return single(Code::control_mode, kPositionControl);
}

Command asynchronousExecution() noexcept {
    return single(Code::execution, kAsynchronous);
}

Command attachTool(int index) noexcept {
    return single(Code::tool, index);
}

std::string describe(const Command& command) {
    const auto* const name = std::ranges::find(kNames, command.code, &Name::first);
    return fmt::format("{} ({})", name == kNames.end() ? "command" : name->second,
                       static_cast<int>(command.code));
}

}  // namespace metier::iiwa_driver
