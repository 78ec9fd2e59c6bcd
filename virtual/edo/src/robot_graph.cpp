#include <algorithm>
#include <array>
#include <string_view>

#include "robot.hpp"

namespace metier::virtual_edo {
namespace {

/// A topic and the releases that have it. They compare as text: each of their numbers is a digit.
struct Topic {
    const char* name;
    const char* type;
    std::string_view from = "2.4.0";
    std::string_view before = "9";
};

// Comau/eDO_core: SubscribePublish.cpp, StateManager.cpp, AlgorithmManager.cpp, TabletCheck.cpp of
// 906c2f4 (2.4.0), 8b99eb3 (3.0.1) and 286074d (3.1.2).
constexpr std::array kTopics{
    // Topics that clients write.
    Topic{"/bridge_init", "edo_core_msgs/JointInit"},
    Topic{"/bridge_jnt_reset", "edo_core_msgs/JointReset"},
    Topic{"/bridge_jnt_calib", "edo_core_msgs/JointCalibration"},
    Topic{"/bridge_jnt_config", "edo_core_msgs/JointConfigurationArray"},
    Topic{"/bridge_move", "edo_core_msgs/MovementCommand"},
    Topic{"/bridge_jog", "edo_core_msgs/MovementCommand"},
    Topic{"/algo_jnt_ctrl", "edo_core_msgs/JointControlArray"},
    Topic{"/tablet_HB_start", "std_msgs/Bool", "3.0.1"},
    Topic{"/tablet_HB", "std_msgs/Int8", "3.0.1"},
    Topic{"/brakes_check_start", "std_msgs/Bool", "3.0.1"},
    Topic{"/algo_coll_thr", "edo_core_msgs/CollisionThreshold", "3.0.1"},
    Topic{"/tool_configuration", "std_msgs/Int8", "3.1.2"},
    Topic{"/external_control", "edo_core_msgs/JointValue", "3.1.2"},
    // Topics that the robot writes.
    Topic{"/machine_state", "edo_core_msgs/MachineState"},
    Topic{"/usb_jnt_state", "edo_core_msgs/JointStateArray"},
    Topic{"/machine_bridge_jnt_state", "edo_core_msgs/JointStateArray", "2.4.0", "3.0.1"},
    Topic{"/app_jnt_state", "edo_core_msgs/AppStateArray", "3.0.1"},
    Topic{"/machine_movement_ack", "edo_core_msgs/MovementFeedback"},
    Topic{"/cartesian_pose", "edo_core_msgs/CartesianPose"},
    Topic{"/algorithm_state", "std_msgs/Int8"},
    Topic{"/brakes_check_ack", "edo_core_msgs/BrakesCheckAck", "3.0.1"},
    Topic{"/machine_jnt_version", "std_msgs/UInt8"},
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

template <typename Call>
void serve(RosGraph& graph, const char* name, const char* type, Call call) {
    graph.services.emplace(name, RosGraph::Service{std::string("edo_core_msgs/") + type, call});
}

}  // namespace

Robot::Topics Robot::topicsOf(const Software& software) {
    Topics topics;
    for (const auto& topic : kTopics) {
        if (software.version >= topic.from && software.version < topic.before) {
            topics.emplace(topic.name, topic.type);
        }
    }
    return topics;
}

RosGraph Robot::graph() {
    RosGraph graph;
    graph.topics = topics_;
    graph.on_message = [this](const std::string& topic, const Json& message) {
        // Under a name that this release does not have clients may agree on any type.
        if (topics_.contains(topic)) {
            onMessage(topic, message);
        }
    };
    serveAlways(graph);
    if (options_.kinematics_services) {
        serveKinematics(graph);
    }
    if (options_.software.external_control) {
        serveToolAndCounter(graph);
    }
    return graph;
}

void Robot::serveAlways(RosGraph& graph) {
    serve(graph, "/algo_jnt_number_srv", "JointsNumber",
          [this](const Json&) { return jointsNumber(); });
    serve(graph, "/algo_control_switch_srv", "ControlSwitch", [this](const Json& arguments) {
        return Result<Json>(
            Json::object({{"result", node_.switchControl(arguments["mode"].get<std::uint8_t>())}}));
    });
    serve(graph, "/algo_load_configuration_file_srv", "LoadConfigurationFile", [this](const Json&) {
        // Loads the configuration that was chosen last, once.
        const bool loaded = node_.axes() == 0 && node_.load(options_.axes) > 0;
        return Result<Json>(Json::object({{"result", loaded ? 1 : 0}}));
    });
    serve(graph, "/machine_bridge_sw_version_srv", "SoftwareVersion",
          [this](const Json&) { return softwareVersions(); });
}

void Robot::serveKinematics(RosGraph& graph) {
    serve(graph, "/algo_direct_kinematics_srv", "DirectKinematics",
          [this](const Json& arguments) { return directKinematics(arguments); });
    serve(graph, "/algo_inverse_kinematics_srv", "InverseKinematics",
          [this](const Json& arguments) { return inverseKinematics(arguments); });
}

void Robot::serveToolAndCounter(RosGraph& graph) {
    serve(graph, "/algo_tool_configuration_srv", "ToolConfiguration", [this](const Json&) {
        return Result<Json>(Json::object({{"tool_id", tool()}}));
    });
    // CalibCounter.cpp: the one ignores `increment`, the other does not return the count.
    serve(graph, "/calibration_counter_srv", "CalibCounter", [this](const Json&) {
        return Result<Json>(Json::object({{"cnt", calibrations_}}));
    });
    serve(graph, "/increment_calib_counter_srv", "CalibCounter", [this](const Json& arguments) {
        constexpr std::uint64_t kCountWithoutIncrement = 2;
        if (arguments["increment"].get<bool>()) {
            countCalibration();
        } else {
            calibrations_ = kCountWithoutIncrement;
        }
        return Result<Json>(Json::object());
    });
}

void Robot::countCalibration() {
    constexpr std::uint64_t kCountsUpTo = 1'000'000;
    calibrations_ = (calibrations_ + 1) % kCountsUpTo;
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
    METIER_ASSIGN(const auto values,
                  node_.planner().inverse(node_.target(),
                                          toPose(cartesianFrom(arguments["cartesian_pose"]))));
    const auto count = static_cast<std::ptrdiff_t>(node_.axes());
    const std::vector<double> positions(values.begin(), values.begin() + count);
    return Json::object({{"positions", Json::object({{"joints_mask", maskOf(node_.axes())},
                                                     {"positions", positions}})}});
}

}  // namespace metier::virtual_edo
