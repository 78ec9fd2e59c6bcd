#include "message_definitions.hpp"

#include <string_view>

namespace metier::virtual_edo {
namespace {

std::vector<Field> fieldsOf(std::string_view type, std::vector<std::string> names) {
    std::vector<Field> fields;
    for (auto& name : names) {
        fields.push_back({std::move(name), std::string(type)});
    }
    return fields;
}

std::string edo(std::string_view name) {
    return "edo_core_msgs/" + std::string(name);
}

void addStandard(Definitions& types) {
    for (const char* name : {"Bool", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64",
                             "UInt64", "Float32", "Float64", "String"}) {
        std::string primitive = name;
        for (auto& character : primitive) {
            character = static_cast<char>(character | 0x20);  // capital letters to small ones
        }
        types["std_msgs/" + std::string(name)] = {{"data", primitive}};
    }
    types["std_msgs/Empty"] = {};
    types["std_srvs/Empty.Request"] = {};
    types["std_srvs/Empty.Response"] = {};
}

void addCommands(Definitions& types, const Software& software) {
    types[edo("JointInit")] = {
        {"mode", "uint8"}, {"joints_mask", "uint64"}, {"reduction_factor", "float32"}};
    types[edo("JointReset")] = {
        {"joints_mask", "uint64"}, {"disengage_steps", "uint32"}, {"disengage_offset", "float32"}};
    types[edo("JointCalibration")] = {{"joints_mask", "uint64"}};
    types[edo("JointConfiguration")] =
        fieldsOf("float32", {"kp", "ti", "td", "sat", "kff", "max", "kpv", "tiv", "tdv", "satv",
                             "kffv", "maxv", "kpt", "tit", "tdt", "satt", "kfft", "maxt", "kt"});
    types[edo("JointConfigurationArray")] = {{"joints_mask", "uint64"},
                                             {"joints", edo("JointConfiguration[]")}};
    types[edo("CartesianPose")] = fieldsOf("float32", {"x", "y", "z", "a", "e", "r"});
    types[edo("CartesianPose")].push_back({"config_flags", "string"});
    types[edo("Frame")] = fieldsOf("float32", {"x", "y", "z", "a", "e", "r"});
    types[edo("Payload")] =
        fieldsOf("float32", {"mass", "x", "y", "z", "xx", "yy", "zz", "xy", "xz", "yz"});
    types[edo("Point")] = {{"data_type", "uint8"},
                           {"cartesian_data", edo("CartesianPose")},
                           {"joints_mask", "uint64"},
                           {"joints_data", "float32[]"}};
    auto& command = types[edo("MovementCommand")];
    command = fieldsOf("uint8", {"move_command", "move_type", "ovr", "delay", "remote_tool"});
    command.insert(command.end(), {{"cartesian_linear_speed", "float32"},
                                   {"target", edo("Point")},
                                   {"via", edo("Point")},
                                   {"tool", edo("Frame")},
                                   {"frame", edo("Frame")}});
    if (software.external_control) {
        command.push_back({"payload", edo("Payload")});
    }
}

void addStates(Definitions& types, const Software& software) {
    types[edo("JointControl")] =
        fieldsOf("float32", {"position", "velocity", "current", "ff_velocity", "ff_current"});
    types[edo("JointControlArray")] = {{"size", "uint8"}, {"joints", edo("JointControl[]")}};
    types[edo("JointState")] = fieldsOf("float32", {"position", "velocity", "current"});
    types[edo("JointState")].push_back(
        {"commandFlag", software.external_control ? "uint16" : "uint8"});
    if (software.residuals) {
        types[edo("JointControl")].push_back({"R_rasp", "float32"});
        types[edo("JointState")].push_back({"R_jnt", "float32"});
    }
    types[edo("JointStateArray")] = {{"joints_mask", "uint64"}, {"joints", edo("JointState[]")}};
    types[edo("JointValue")] = fieldsOf("float32[7]", {"position", "ff_velocity", "ff_current"});
    types[edo("MachineState")] = {{"current_state", "uint8"}, {"opcode", "uint32"}};
    types[edo("MovementFeedback")] = fieldsOf("int8", {"type", "data"});
    types[edo("AppState")] = fieldsOf("float32", {"position", "velocity"});
    types[edo("AppStateArray")] = {{"joints_mask", "uint32"}, {"joints", edo("AppState[]")}};
    types[edo("CollisionThreshold")] = {{"joints_mask", "uint64"}, {"threshold", "float32"}};
    types[edo("CollisionAlgoToState")] = {{"joints_mask", "uint8"}, {"coll_flag", "bool"}};
    types[edo("BrakesCheckAck")] = {{"state", "int8"}, {"mask", "uint8"}};
    types[edo("JointFwVersion")] = {{"id", "uint8"},
                                    {"majorRev", "uint8"},
                                    {"minorRev", "uint16"},
                                    {"revision", "uint16"},
                                    {"svn", "uint16"}};
    types[edo("JointFwVersionArray")] = {{"joints", edo("JointFwVersion[]")}};
    types[edo("NodeSwVersion")] = {{"id", "uint16"}, {"version", "string"}};
    types[edo("NodeSwVersionArray")] = {{"nodes", edo("NodeSwVersion[]")}};
    types[edo("JointsPositions")] = {
        {"joints_mask", "uint64"}, {"joints_type", "uint8[]"}, {"positions", "float32[]"}};
}

void addServices(Definitions& types) {
    types[edo("ControlSwitch.Request")] = {{"mode", "uint8"}};
    types[edo("ControlSwitch.Response")] = {{"result", "uint8"}};
    types[edo("JointsNumber.Request")] = {};
    types[edo("JointsNumber.Response")] = {
        {"counter", "int8"}, {"joints_mask", "uint32"}, {"joints_aux_mask", "uint32"}};
    types[edo("SoftwareVersion.Request")] = {};
    types[edo("SoftwareVersion.Response")] = {{"version", edo("NodeSwVersionArray")},
                                              {"tool_id", "int8"}};
    types[edo("DirectKinematics.Request")] = {{"positions", edo("JointsPositions")}};
    types[edo("DirectKinematics.Response")] = {{"cartesian_pose", edo("CartesianPose")}};
    types[edo("InverseKinematics.Request")] = {{"cartesian_pose", edo("CartesianPose")}};
    types[edo("InverseKinematics.Response")] = {{"positions", edo("JointsPositions")}};
    types[edo("LoadConfigurationFile.Request")] = {};
    types[edo("LoadConfigurationFile.Response")] = {{"result", "uint8"}};
    types[edo("ToolConfiguration.Request")] = {};
    types[edo("ToolConfiguration.Response")] = {{"tool_id", "int8"}};
    types[edo("CalibCounter.Request")] = {{"increment", "bool"}};
    types[edo("CalibCounter.Response")] = {{"cnt", "uint64"}};
    types[edo("SystemCommandSrv.Request")] = {{"command", "uint8"}, {"data", "string"}};
    types[edo("SystemCommandSrv.Response")] = {{"res", "string"}};
}

void addRosApi(Definitions& types) {
    types["time"] = fieldsOf("uint32", {"secs", "nsecs"});
    types["rosapi/Topics.Request"] = {};
    types["rosapi/Topics.Response"] = fieldsOf("string[]", {"topics", "types"});
    types["rosapi/TopicType.Request"] = {{"topic", "string"}};
    types["rosapi/TopicType.Response"] = {{"type", "string"}};
    types["rosapi/TopicsForType.Request"] = {{"type", "string"}};
    types["rosapi/TopicsForType.Response"] = {{"topics", "string[]"}};
    types["rosapi/Services.Request"] = {};
    types["rosapi/Services.Response"] = {{"services", "string[]"}};
    types["rosapi/ServiceType.Request"] = {{"service", "string"}};
    types["rosapi/ServiceType.Response"] = {{"type", "string"}};
    types["rosapi/GetTime.Request"] = {};
    types["rosapi/GetTime.Response"] = {{"time", "time"}};
}

}  // namespace

Definitions definitionsFor(const Software& software) {
    Definitions types;
    addStandard(types);
    addCommands(types, software);
    addStates(types, software);
    addServices(types);
    addRosApi(types);
    return types;
}

}  // namespace metier::virtual_edo
