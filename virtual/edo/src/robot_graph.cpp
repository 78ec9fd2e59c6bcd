#include <algorithm>
#include <array>

#include "metier/virtual_edo/robot.hpp"

namespace metier::virtual_edo {
namespace {

struct Named {
    const char* name;
    const char* type;
};

constexpr std::array kTopics{
    // What clients write.
    Named{"/bridge_init", "edo_core_msgs/JointInit"},
    Named{"/bridge_jnt_reset", "edo_core_msgs/JointReset"},
    Named{"/bridge_jnt_calib", "edo_core_msgs/JointCalibration"},
    Named{"/bridge_jnt_config", "edo_core_msgs/JointConfigurationArray"},
    Named{"/bridge_move", "edo_core_msgs/MovementCommand"},
    Named{"/bridge_jog", "edo_core_msgs/MovementCommand"},
    Named{"/algo_jnt_ctrl", "edo_core_msgs/JointControlArray"},
    Named{"/tablet_HB_start", "std_msgs/Bool"},
    Named{"/tablet_HB", "std_msgs/Int8"},
    Named{"/brakes_check_start", "std_msgs/Bool"},
    Named{"/tool_configuration", "std_msgs/Int8"},
    Named{"/algo_coll_thr", "edo_core_msgs/CollisionThreshold"},
    // What the robot writes.
    Named{"/machine_state", "edo_core_msgs/MachineState"},
    Named{"/usb_jnt_state", "edo_core_msgs/JointStateArray"},
    Named{"/app_jnt_state", "edo_core_msgs/AppStateArray"},
    Named{"/machine_movement_ack", "edo_core_msgs/MovementFeedback"},
    Named{"/cartesian_pose", "edo_core_msgs/CartesianPose"},
    Named{"/algorithm_state", "std_msgs/Int8"},
    Named{"/brakes_check_ack", "edo_core_msgs/BrakesCheckAck"},
    Named{"/machine_jnt_version", "std_msgs/UInt8"},
};

AxisValues axisValues(const Json& list) {
    AxisValues values{};
    const auto count = std::min(list.size(), values.size());
    for (std::size_t axis = 0; axis < count; ++axis) {
        values[axis] = list[axis].get<double>();
    }
    return values;
}

std::uint64_t maskIn(const Json& message) {
    return message["joints_mask"].get<std::uint64_t>();
}

}  // namespace

RosGraph Robot::graph() {
    RosGraph graph;
    for (const auto& topic : kTopics) {
        graph.topics.emplace(topic.name, topic.type);
    }
    if (options_.software.external_control) {
        graph.topics.emplace("/external_control", "edo_core_msgs/JointValue");
    }
    graph.on_message = [this](const std::string& topic, const Json& message) {
        onMessage(topic, message);
    };
    const auto serve = [&](const char* name, const char* type, auto call) {
        graph.services.emplace(name, RosGraph::Service{std::string("edo_core_msgs/") + type, call});
    };
    serve("/algo_jnt_number_srv", "JointsNumber", [this](const Json&) { return jointsNumber(); });
    serve("/algo_control_switch_srv", "ControlSwitch", [this](const Json& arguments) {
        return Result<Json>(
            Json::object({{"result", node_.switchControl(arguments["mode"].get<std::uint8_t>())}}));
    });
    serve("/algo_direct_kinematics_srv", "DirectKinematics",
          [this](const Json& arguments) { return directKinematics(arguments); });
    serve("/algo_inverse_kinematics_srv", "InverseKinematics",
          [this](const Json& arguments) { return inverseKinematics(arguments); });
    serve("/algo_load_configuration_file_srv", "LoadConfigurationFile", [this](const Json&) {
        // Loads the configuration that was chosen last, once.
        const bool loaded = node_.axes() == 0 && node_.load(options_.axes) > 0;
        return Result<Json>(Json::object({{"result", loaded ? 1 : 0}}));
    });
    serve("/algo_tool_configuration_srv", "ToolConfiguration", [this](const Json&) {
        return Result<Json>(Json::object({{"tool_id", tool()}}));
    });
    serve("/machine_bridge_sw_version_srv", "SoftwareVersion",
          [this](const Json&) { return softwareVersions(); });
    serve("/calibration_counter_srv", "CalibCounter", [this](const Json& arguments) {
        calibrations_ += arguments["increment"].get<bool>() ? 1 : 0;
        return Result<Json>(Json::object({{"cnt", calibrations_}}));
    });
    return graph;
}

bool Robot::isCommand(const std::string& topic) const {
    return topic.starts_with("/bridge_") || topic == "/brakes_check_start";
}

void Robot::onMessage(const std::string& topic, const Json& message) {
    if (isCommand(topic) && commands_to_drop_ > 0) {
        --commands_to_drop_;
        return;
    }
    if (topic == "/bridge_init") {
        machine_.onInit(message["mode"].get<std::uint8_t>(), maskIn(message));
    } else if (topic == "/bridge_jnt_reset") {
        if (machine_.state() == MachineState::braked) {
            node_.onReset();
        }
        machine_.onReset(maskIn(message));
    } else if (topic == "/bridge_jnt_calib") {
        machine_.onCalibration(maskIn(message));
    } else if (topic == "/bridge_jnt_config") {
        machine_.onConfiguration(maskIn(message));
    } else if (topic == "/bridge_move") {
        machine_.onMove(Movement::from(message));
    } else if (topic == "/bridge_jog") {
        machine_.onJog(Movement::from(message));
    } else if (topic == "/algo_jnt_ctrl") {
        onSetPoints(message);
    } else if (topic == "/external_control") {
        onExternalControl(message);
    } else if (topic == "/tablet_HB_start") {
        machine_.onHeartbeatStart(message["data"].get<bool>());
    } else if (topic == "/tablet_HB") {
        machine_.onHeartbeat();
    } else if (topic == "/brakes_check_start") {
        machine_.onBrakesCheckStart(message["data"].get<bool>());
    } else if (topic == "/tool_configuration") {
        tool_ = message["data"].get<std::int8_t>();
    }
}

void Robot::onSetPoints(const Json& message) {
    std::vector<double> positions;
    for (const auto& joint : message["joints"]) {
        positions.push_back(joint["position"].get<double>());
    }
    client_set_points_ = true;
    bus_.command(positions);
}

void Robot::onExternalControl(const Json& message) {
    node_.externalControl(axisValues(message["position"]), axisValues(message["ff_velocity"]));
}

std::int8_t Robot::tool() const {
    constexpr std::int8_t kNoTool = 0;
    constexpr std::int8_t kGripperTool = 1;
    if (tool_ >= 0) {
        return tool_;
    }
    return node_.axes() > kArmAxes ? kGripperTool : kNoTool;
}

Result<Json> Robot::jointsNumber() const {
    constexpr int kNotConfigured = -2;
    if (node_.axes() == 0) {
        return Json::object({{"counter", kNotConfigured}});
    }
    const std::uint64_t auxiliary = maskOf(node_.axes()) & ~maskOf(kArmAxes);
    return Json::object({{"counter", node_.axes()},
                         {"joints_mask", maskOf(node_.axes())},
                         {"joints_aux_mask", auxiliary}});
}

Result<Json> Robot::softwareVersions() const {
    constexpr int kRaspberry = 255;
    constexpr int kMac = 253;
    constexpr int kLicence = 254;
    Json nodes = Json::array();
    const auto add = [&](std::size_t id, const std::string& version) {
        nodes.push_back({{"id", id}, {"version", version}});
    };
    add(0, node_.axes() > 0 ? "edo_2.0.999.999" : "usb");
    add(kRaspberry, "edo_" + options_.software.version);
    add(kMac, "02:00:00:ed:00:01");
    add(kLicence, "no license");
    for (std::size_t axis = 1; axis <= node_.axes(); ++axis) {
        add(axis, "edo_2.0.999.999");
    }
    return Json::object({{"version", Json::object({{"nodes", nodes}})}, {"tool_id", tool()}});
}

Result<Json> Robot::directKinematics(const Json& arguments) const {
    const auto pose = node_.planner().cartesian(axisValues(arguments["positions"]["positions"]));
    return Json::object({{"cartesian_pose", toJson(pose)}});
}

Result<Json> Robot::inverseKinematics(const Json& arguments) const {
    const auto values =
        node_.planner().inverse(node_.target(), toPose(cartesianFrom(arguments["cartesian_pose"])));
    if (!values) {
        return fail(values.error());
    }
    const auto count = static_cast<std::ptrdiff_t>(node_.axes());
    const std::vector<double> positions(values->begin(), values->begin() + count);
    return Json::object({{"positions", Json::object({{"joints_mask", maskOf(node_.axes())},
                                                     {"positions", positions}})}});
}

}  // namespace metier::virtual_edo
