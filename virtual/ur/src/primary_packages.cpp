#include "primary_packages.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace metier::virtual_ur {

namespace {

constexpr std::string_view kName = "URControl";

constexpr std::uint8_t kRobotState = 16;
constexpr std::uint8_t kRobotMessage = 20;

// Source of a message, as seen in captured streams.
constexpr std::int8_t kFromController = -2;
constexpr std::int8_t kFromProgram = -3;

constexpr MessageTime kNoTime = std::numeric_limits<MessageTime>::max();

Bytes package(std::uint8_t type, const ByteWriter& body) {
    ByteWriter whole;
    whole.put(static_cast<std::int32_t>(body.content().size() + 5)).put(type);
    return whole.bytes(body.content()).content();
}

ByteWriter message(MessageTime time, std::int8_t source, std::uint8_t kind) {
    return ByteWriter().put(time).put(source).put(kind);
}

std::uint8_t shortLength(std::string_view text) {
    return static_cast<std::uint8_t>(std::min<std::size_t>(text.size(), 255));
}

float toFloat(double value) {
    return static_cast<float>(value);
}

Bytes robotMode(const RobotState& state) {
    const bool paused =
        state.runtime_state == RuntimeState::paused || state.runtime_state == RuntimeState::pausing;
    const bool stopped = state.runtime_state == RuntimeState::stopped;
    return package(0, ByteWriter()
                          .put(timeOf(state))
                          .put(true)  // a robot is connected
                          .put(true)  // and enabled
                          .put(state.robot_mode > RobotMode::power_off)
                          .put(state.safety_mode == SafetyMode::robot_emergency_stop)
                          .put(state.safety_mode == SafetyMode::protective_stop)
                          .put(!stopped && !paused)
                          .put(paused)
                          .put(static_cast<std::int8_t>(state.robot_mode))
                          .put(std::uint8_t{0})  // control by position
                          .put(state.speed_slider)
                          .put(state.speed_scaling)
                          .put(1.0)  // the most the slider may be
                          .zeros(1));
}

Bytes joints(const RobotState& state) {
    ByteWriter body;
    for (std::size_t i = 0; i < kAxes; ++i) {
        body.put(state.actual_q[i])
            .put(state.target_q[i])
            .put(state.actual_qd[i])
            .put(0.0F)  // current
            .put(toFloat(state.joint_voltage[i]))
            .put(toFloat(state.joint_temperature[i]))
            .put(0.0F)
            .put(static_cast<std::uint8_t>(state.joint_mode[i]));
    }
    return package(1, body);
}

Bytes tool(const RobotState& state) {
    return package(2, ByteWriter()
                          .putAll(state.io.tool_analog_input_domains)
                          .putAll(state.io.tool_analog_inputs)
                          .put(toFloat(state.robot_voltage))
                          .put(static_cast<std::uint8_t>(state.io.tool_voltage))
                          .put(0.0F)  // current
                          .put(toFloat(state.joint_temperature.back()))
                          .put(static_cast<std::uint8_t>(state.joint_mode.back())));
}

Bytes masterboard(const RobotState& state) {
    return package(3, ByteWriter()
                          .put(static_cast<std::uint32_t>(state.io.digital_inputs))
                          .put(static_cast<std::uint32_t>(state.io.digital_outputs))
                          .putAll(state.io.analog_input_domains)
                          .putAll(state.io.analog_inputs)
                          .putAll(state.io.analog_output_domains)
                          .putAll(state.io.analog_outputs)
                          .put(toFloat(state.joint_temperature.front()))
                          .put(toFloat(state.robot_voltage))
                          .put(toFloat(state.robot_current))
                          .put(0.0F)  // current of the inputs and outputs
                          .put(static_cast<std::uint8_t>(state.safety_mode))
                          .put(std::uint8_t{0})  // not in reduced mode
                          .put(std::uint8_t{0})  // no injection moulding interface
                          .zeros(4)
                          .put(std::uint8_t{1})  // operational mode selector
                          .put(std::uint8_t{1})  // enabling device
                          .zeros(1));
}

Bytes cartesian(const RobotState& state) {
    return package(4, ByteWriter().putAll(state.actual_tcp_pose).putAll(state.tcp_offset));
}

/// Denavit-Hartenberg parameters of a chain whose axes are all z.
struct DhTable {
    Vector6 theta{};
    Vector6 a{};
    Vector6 d{};
    Vector6 alpha{};
};

DhTable dhOf(const motion::RobotModel& model) {
    // The pose from one axis' frame to the next is Rz(theta) Tz(d) Tx(a) Rx(alpha).
    DhTable table;
    const auto& joints = model.chain().joints;
    for (std::size_t i = 0; i < kAxes; ++i) {
        const auto& next =
            i + 1 < kAxes ? joints[i + 1].parent_from_joint : model.chain().last_from_flange;
        const Eigen::Matrix3d turn = next.rotation.toRotationMatrix();
        table.theta[i] = std::atan2(turn(1, 0), turn(0, 0));
        table.alpha[i] = std::atan2(turn(2, 1), turn(2, 2));
        table.d[i] = next.translation.z();
        table.a[i] = next.translation.x() * std::cos(table.theta[i]) +
                     next.translation.y() * std::sin(table.theta[i]);
    }
    return table;
}

Bytes kinematics(const DhTable& dh) {
    ByteWriter body;
    for (std::size_t i = 0; i < kAxes; ++i) {
        // Checksum of the axis' parameters: equal parameters give equal sums, as with the maker's.
        std::uint64_t sum = 0;
        for (const double value : {dh.theta[i], dh.a[i], dh.d[i], dh.alpha[i]}) {
            sum = sum * 31 + std::bit_cast<std::uint64_t>(value);
        }
        body.put(static_cast<std::uint32_t>(sum >> 32U ^ sum));
    }
    body.putAll(dh.theta).putAll(dh.a).putAll(dh.d).putAll(dh.alpha).put(std::uint32_t{1});
    return package(5, body);
}

Bytes configuration(const RobotDescription& robot, const DhTable& dh) {
    ByteWriter body;
    for (std::size_t i = 0; i < kAxes; ++i) {
        body.put(robot.model->limits(i).lower).put(robot.model->limits(i).upper);
    }
    for (std::size_t i = 0; i < kAxes; ++i) {
        body.put(robot.model->limits(i).velocity).put(robot.joint_acceleration[i]);
    }
    // Defaults of joint and tool moves [rad/s], [rad/s2], [m/s], [m/s2]; equivalent radius [m].
    body.put(1.0471975511965976).put(1.3962634015954636).put(0.25).put(1.2).put(0.1);
    body.putAll(dh.a).putAll(dh.d).putAll(dh.alpha).putAll(dh.theta);
    const bool e_series = robot.series == Series::e_series;
    body.put(std::int32_t{4})
        .put(std::int32_t{e_series ? 5 : 3})  // control box
        .put(robot.robot_type)
        .put(std::int32_t{e_series ? 5 : 1});  // generation
    return package(6, body);
}

Bytes force(const RobotState& state) {
    return package(7, ByteWriter().putAll(state.actual_tcp_force).put(0.0));
}

/// A part that is not documented, or has no meaning for a virtual arm.
Bytes empty(std::uint8_t type, std::size_t content) {
    return package(type, ByteWriter().zeros(content));
}

}  // namespace

MessageTime timeOf(const RobotState& state) {
    return static_cast<MessageTime>(std::llround(state.timestamp * 1e6));
}

Bytes robotStatePackage(const RobotState& state, const RobotDescription& robot) {
    const auto dh = dhOf(*robot.model);
    ByteWriter body;
    body.bytes(robotMode(state))
        .bytes(joints(state))
        .bytes(cartesian(state))
        .bytes(kinematics(dh))
        .bytes(configuration(robot, dh))
        .bytes(masterboard(state))
        .bytes(empty(8, 4))
        .bytes(tool(state))
        .bytes(force(state))
        .bytes(empty(9, 48))
        .bytes(empty(10, 38));
    if (robot.series == Series::e_series) {
        body.bytes(empty(11, 21)).bytes(empty(12, 7));
    }
    return package(kRobotState, body);
}

Bytes versionMessage(const RobotDescription& robot) {
    return package(kRobotMessage, message(kNoTime, kFromController, 3)
                                      .put(shortLength(kName))
                                      .text(kName)
                                      .put(static_cast<std::uint8_t>(robot.version.major))
                                      .put(static_cast<std::uint8_t>(robot.version.minor))
                                      .put(static_cast<std::int32_t>(robot.version.bugfix))
                                      .put(static_cast<std::int32_t>(robot.version.build))
                                      .text(robot.build_date));
}

Bytes textMessage(MessageTime time, std::string_view text) {
    return package(kRobotMessage, message(time, kFromProgram, 0).text(text));
}

Bytes keyMessage(MessageTime time, std::string_view title, std::string_view text) {
    return package(kRobotMessage, message(time, kFromProgram, 7)
                                      .put(std::int32_t{0})
                                      .put(std::int32_t{0})
                                      .put(shortLength(title))
                                      .text(title)
                                      .text(text));
}

Bytes safetyModeMessage(MessageTime time, SafetyMode mode) {
    return package(kRobotMessage, message(time, kFromController, 5)
                                      .put(std::int32_t{0})
                                      .put(std::int32_t{0})
                                      .put(static_cast<std::uint8_t>(mode))
                                      .put(std::uint32_t{0})
                                      .put(std::uint32_t{0}));
}

Bytes runtimeExceptionMessage(MessageTime time, int line, int column, std::string_view text) {
    return package(kRobotMessage, message(time, kFromProgram, 10)
                                      .put(std::int32_t{line})
                                      .put(std::int32_t{column})
                                      .text(text));
}

Bytes errorCodeMessage(MessageTime time, const ErrorCode& error) {
    return package(kRobotMessage, message(time, kFromController, 6)
                                      .put(error.code)
                                      .put(error.argument)
                                      .put(static_cast<std::int32_t>(error.level))
                                      .put(std::uint32_t{0})
                                      .put(std::uint32_t{0})
                                      .text(error.text));
}

Bytes popupMessage(MessageTime time, const urscript::Popup& popup) {
    return package(kRobotMessage, message(time, kFromController, 2)
                                      .put(std::uint32_t{0})
                                      .put(std::uint8_t{0})
                                      .put(popup.level == urscript::Popup::Level::warning)
                                      .put(popup.level == urscript::Popup::Level::error)
                                      .put(popup.blocking)
                                      .put(shortLength(popup.title))
                                      .text(std::string_view(popup.title).substr(0, 255))
                                      .text(popup.text));
}

}  // namespace metier::virtual_ur
