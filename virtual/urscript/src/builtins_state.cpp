#include <cmath>

#include "call.hpp"
#include "pose_math.hpp"

namespace metier::urscript {
namespace {

/// Status of freedrive: far from a singular place; 1 would be near one, 2 too near.
constexpr std::int32_t kFarFromSingular = 0;

/// One item of the robot's state.
template <auto item>
Value get(Call& call) {
    return call.robot().state().*item;
}

Value force(Call& call) {
    const Vector6& wrench = call.robot().state().wrench;
    return std::hypot(wrench[0], wrench[1], wrench[2]);
}

Value jointTemperature(Call& call) {
    const int joint = call.integer(0);
    const Vector6& temperatures = call.robot().state().joint_temperature;
    if (joint < 0 || static_cast<std::size_t>(joint) >= temperatures.size()) {
        return call.failed(Errc::out_of_range, "there is no joint " + std::to_string(joint));
    }
    return temperatures[static_cast<std::size_t>(joint)];
}

Value payloadCog(Call& call) {
    const Vector3& cog = call.robot().state().payload_cog;
    return std::vector<Value>(cog.begin(), cog.end());
}

Value flangePose(Call& call) {
    const RobotState& state = call.robot().state();
    return transformed(state.actual_tool_pose, inverted(state.flange_from_tool));
}

/// The tool frame that an argument gives; none and a name ("active_tcp") mean the one that is set.
Pose toolOf(Call& call, std::size_t index) {
    const bool active = !call.given(index) || call.value(index).get<std::string>() != nullptr;
    return active ? call.robot().state().flange_from_tool : call.pose(index);
}

Result<Vector6> solve(Call& call) {
    const Pose base_from_tool = call.pose(0);
    const Vector6 near =
        call.given(1) ? call.vector6(1) : call.robot().state().actual_joint_position;
    const Pose flange_from_tool = toolOf(call, 4);
    if (!call.ok()) {
        return fail(*call.error());
    }
    return call.robot().inverseKinematics(base_from_tool, near, flange_from_tool);
}

Value forward(Call& call) {
    const bool current = !call.given(0) || call.value(0).get<std::string>() != nullptr;
    const Vector6 joint_position =
        current ? call.robot().state().actual_joint_position : call.vector6(0);
    const Pose flange_from_tool = toolOf(call, 1);
    if (!call.ok()) {
        return {};
    }
    return call.checked(call.robot().forwardKinematics(joint_position, flange_from_tool));
}

Value withinLimits(Call& call) {
    const Target target = call.target(0);
    return call.ok() ? Value(call.robot().withinLimits(target)) : Value();
}

Value history(Call& call) {
    const int steps = call.integer(0, 0);
    return call.ok() ? call.checked(call.robot().jointPositionHistory(steps)) : Value();
}

Value contact(Call& call) {
    const Vector6 direction = call.given(0) ? call.vector6(0) : Vector6{};
    return call.ok() ? Value(call.robot().toolContact(direction)) : Value();
}

}  // namespace

std::span<const Builtin> stateBuiltins() {
    using State = RobotState;
    static constexpr const char* kInverse = "x qnear maxPositionError maxOrientationError tcp";
    static constexpr Builtin kAll[] = {
        {"force", "", 0, force},
        {"get_actual_joint_positions", "", 0, get<&State::actual_joint_position>},
        {"get_actual_joint_positions_history", "steps", 0, history},
        {"get_actual_joint_speeds", "", 0, get<&State::actual_joint_velocity>},
        {"get_actual_tcp_pose", "", 0, get<&State::actual_tool_pose>},
        {"get_actual_tcp_speed", "", 0, get<&State::actual_twist>},
        {"get_actual_tool_flange_pose", "", 0, flangePose},
        {"get_forward_kin", "q tcp", 0, forward},
        {"get_freedrive_status", "", 0, [](Call&) { return Value(kFarFromSingular); }},
        {"get_inverse_kin", kInverse, 1, [](Call& call) { return call.checked(solve(call)); }},
        {"get_inverse_kin_has_solution", kInverse, 1,
         [](Call& call) { return Value(solve(call).has_value()); }},
        {"get_joint_positions", "", 0, get<&State::actual_joint_position>},
        {"get_joint_speeds", "", 0, get<&State::actual_joint_velocity>},
        {"get_joint_temp", "j", 1, jointTemperature},
        {"get_joint_torques", "", 0, get<&State::joint_torque>},
        {"get_target_joint_positions", "", 0, get<&State::target_joint_position>},
        {"get_target_joint_speeds", "", 0, get<&State::target_joint_velocity>},
        {"get_target_payload", "", 0, get<&State::payload_mass>},
        {"get_target_payload_cog", "", 0, payloadCog},
        {"get_target_payload_inertia", "", 0, get<&State::payload_inertia>},
        {"get_target_tcp_pose", "", 0, get<&State::target_tool_pose>},
        {"get_target_tcp_speed", "", 0, get<&State::target_twist>},
        {"get_target_waypoint", "", 0,
         [](Call& call) { return Value(call.robot().targetWaypoint()); }},
        {"get_tcp_force", "", 0, get<&State::wrench>},
        {"get_tcp_offset", "", 0, get<&State::flange_from_tool>},
        {"get_tcp_pose", "", 0, get<&State::actual_tool_pose>},
        {"get_tcp_speed", "", 0, get<&State::actual_twist>},
        {"is_steady", "", 0, get<&State::steady>},
        {"is_within_safety_limits", "pose", 1, withinLimits},
        {"tool_contact", "direction", 0, contact},
    };
    return kAll;
}

}  // namespace metier::urscript
