#include "realtime_package.hpp"

#include <algorithm>

namespace metier::virtual_ur {

namespace {

// The field "program state": stopped, stopping, playing, pausing, paused, resuming (believed).
double programState(RuntimeState state) {
    switch (state) {
        case RuntimeState::stopping:
            return 5;
        case RuntimeState::playing:
            return 2;
        case RuntimeState::pausing:
        case RuntimeState::paused:
            return 3;
        case RuntimeState::resuming:
            return 4;
        case RuntimeState::stopped:
            break;
    }
    return 1;
}

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
        .put(programState(state.runtime_state))
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
    const Bytes content = std::move(body).take();
    package.put(static_cast<std::int32_t>(content.size() + 4)).bytes(content);
    return std::move(package).take();
}

}  // namespace metier::virtual_ur
