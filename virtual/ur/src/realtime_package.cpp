#include <array>

#include "primary_packages.hpp"

namespace metier::virtual_ur {

namespace {

// The field "program state" by RuntimeState: stopping, stopped, playing, pausing, paused, resuming
// (believed).
constexpr std::array kProgramStates{5.0, 1.0, 2.0, 3.0, 3.0, 4.0};

void putDoubles(ByteWriter& body, std::size_t zeros) {
    body.zeros(zeros * sizeof(double));
}

void putMotion(ByteWriter& body, const RobotState& state) {
    body.put(state.timestamp).putAll(state.target_q).putAll(state.target_qd);
    body.putAll(state.target_qdd);
    putDoubles(body, 12);  // target currents and moments
    body.putAll(state.actual_q).putAll(state.actual_qd);
    putDoubles(body, 12);  // actual and control currents
    body.putAll(state.actual_tcp_pose)
        .putAll(state.actual_tcp_speed)
        .putAll(state.actual_tcp_force)
        .putAll(state.target_tcp_pose)
        .putAll(state.target_tcp_speed);
}

void putModes(ByteWriter& body, const RobotState& state) {
    body.put(static_cast<double>(state.io.digital_inputs)).putAll(state.joint_temperature);
    putDoubles(body, 2);  // controller timer and test value
    body.put(static_cast<double>(state.robot_mode));
    for (const auto mode : state.joint_mode) {
        body.put(static_cast<double>(mode));
    }
    body.put(static_cast<double>(state.safety_mode));
    putDoubles(body, 6 + 3 + 6);  // reserved, accelerometer of the tool, reserved
    body.put(state.speed_scaling);
    putDoubles(body, 1 + 2);  // momentum, reserved
    body.put(state.main_voltage).put(state.robot_voltage).put(state.robot_current);
    body.putAll(state.joint_voltage)
        .put(static_cast<double>(state.io.digital_outputs))
        .put(kProgramStates.at(static_cast<std::size_t>(state.runtime_state)))
        .putAll(state.elbow_position)
        .putAll(state.elbow_velocity)
        .put(static_cast<double>(state.safety_mode));  // safety status
}

}  // namespace

Bytes realtimePackage(const RobotState& state, Series series) {
    ByteWriter body;
    putMotion(body, state);
    putModes(body, state);
    if (series == Series::e_series) {
        putDoubles(body, 3);  // reserved
        body.put(state.payload).putAll(state.payload_cog).putAll(state.payload_inertia);
    }
    ByteWriter package;
    package.put(static_cast<std::int32_t>(body.content().size() + 4)).bytes(body.content());
    return package.content();
}

}  // namespace metier::virtual_ur
