#include "message_types.hpp"
#include "metier/base/text.hpp"

namespace metier::virtual_edo {
namespace {

// Every type with the fields that all releases have: their type, then their names. The answer of a
// service comes behind its request.
constexpr std::string_view kTypes =
    R"(JointInit: uint8 mode; uint64 joints_mask; float32 reduction_factor
JointReset: uint64 joints_mask; uint32 disengage_steps; float32 disengage_offset
JointCalibration: uint64 joints_mask
JointConfiguration: float32 kp ti td sat kff max kpv tiv tdv satv kffv maxv
JointConfiguration: float32 kpt tit tdt satt kfft maxt kt
JointConfigurationArray: uint64 joints_mask; JointConfiguration[] joints
CartesianPose: float32 x y z a e r; string config_flags
Frame: float32 x y z a e r
Payload: float32 mass x y z xx yy zz xy xz yz
Point: uint8 data_type; CartesianPose cartesian_data; uint64 joints_mask; float32[] joints_data
MovementCommand: uint8 move_command move_type ovr delay remote_tool
MovementCommand: float32 cartesian_linear_speed; Point target via; Frame tool frame
JointControl: float32 position velocity current ff_velocity ff_current
JointControlArray: uint8 size; JointControl[] joints
JointState: float32 position velocity current
JointStateArray: uint64 joints_mask; JointState[] joints
JointValue: float32[7] position ff_velocity ff_current
MachineState: uint8 current_state; uint32 opcode
MovementFeedback: int8 type data
AppState: float32 position velocity
AppStateArray: uint32 joints_mask; AppState[] joints
CollisionThreshold: uint64 joints_mask; float32 threshold
CollisionAlgoToState: uint8 joints_mask; bool coll_flag
BrakesCheckAck: int8 state; uint8 mask
JointFwVersion: uint8 id majorRev; uint16 minorRev revision svn
JointFwVersionArray: JointFwVersion[] joints
NodeSwVersion: uint16 id; string version
NodeSwVersionArray: NodeSwVersion[] nodes
JointsPositions: uint64 joints_mask; uint8[] joints_type; float32[] positions
ControlSwitch: uint8 mode --- uint8 result
JointsNumber: --- int8 counter; uint32 joints_mask joints_aux_mask
SoftwareVersion: --- NodeSwVersionArray version; int8 tool_id
DirectKinematics: JointsPositions positions --- CartesianPose cartesian_pose
InverseKinematics: CartesianPose cartesian_pose --- JointsPositions positions
LoadConfigurationFile: --- uint8 result
ToolConfiguration: --- int8 tool_id
CalibCounter: bool increment --- uint64 cnt
SystemCommandSrv: uint8 command; string data --- string res
std_msgs/Empty:
std_srvs/Empty: ---
time: uint32 secs nsecs
rosapi/Topics: --- string[] topics types
rosapi/TopicType: string topic --- string type
rosapi/TopicsForType: string type --- string[] topics
rosapi/Services: --- string[] services
rosapi/ServiceType: string service --- string type
rosapi/GetTime: --- time time)";

/// The robot's own types begin with a capital letter.
std::string wholeName(std::string_view name) {
    const bool own = name.front() >= 'A' && name.front() <= 'Z';
    return (own ? "edo_core_msgs/" : "") + std::string(name);
}

/// \param text "float32 x y; string name"
void addFields(std::vector<Field>& fields, std::string_view text) {
    for (const auto group : split(text, ';')) {
        const auto words = split(trimmed(group), ' ');
        for (std::size_t i = 1; i < words.size(); ++i) {
            fields.push_back({std::string(words[i]), wholeName(words[0])});
        }
    }
}

}  // namespace

Definitions definitionsFor(const Software& software) {
    constexpr std::string_view kAnswer = "---";
    Definitions types;
    for (const auto line : split(kTypes, '\n')) {
        const auto colon = line.find(':');
        const auto name = wholeName(line.substr(0, colon));
        const auto fields = line.substr(colon + 1);
        if (const auto answer = fields.find(kAnswer); answer != std::string_view::npos) {
            addFields(types[name + ".Request"], fields.substr(0, answer));
            addFields(types[name + ".Response"], fields.substr(answer + kAnswer.size()));
        } else {
            addFields(types[name], fields);
        }
    }
    for (const std::string name : {"Bool", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32",
                                   "Int64", "UInt64", "Float32", "Float64", "String"}) {
        types["std_msgs/" + name] = {{"data", inLowerCase(name)}};
    }
    auto& joint_state = types[wholeName("JointState")];
    joint_state.push_back({"commandFlag", software.external_control ? "uint16" : "uint8"});
    if (software.residuals) {
        joint_state.push_back({"R_jnt", "float32"});
        types[wholeName("JointControl")].push_back({"R_rasp", "float32"});
    }
    if (software.external_control) {
        types[wholeName("MovementCommand")].push_back({"payload", wholeName("Payload")});
    }
    return types;
}

}  // namespace metier::virtual_edo
