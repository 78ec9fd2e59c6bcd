#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "metier/opcua_skill/motion_device_system.hpp"
#include "metier/opcua_skill/values.hpp"
#include "model_ids.hpp"
#include "robot_values.hpp"
#include "value_part.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::AddressSpace;
using opcua::NodeId;
using opcua::QualifiedName;
using opcua::Value;
using ReadState = std::function<KinematicsState()>;

/// Sets and wires the Variables below one Kinematics object.
class KinematicsNodes {
public:
    KinematicsNodes(AddressSpace& nodes, NodeId kinematics, std::uint16_t index)
        : nodes_(nodes), kinematics_(std::move(kinematics)), index_(index) {}

    void set(const char* name, const Value& value) {
        with(name, [&](const NodeId& node) { return nodes_.write(node, value); });
    }

    void setFrame(const char* name, const opcua::ThreeDFrame& frame) {
        with(name, [&](const NodeId& node) {
            return forEachPart(nodes_, node, [&](const NodeId& variable, Part part) {
                return nodes_.write(variable, partOf(frame, part));
            });
        });
    }

    void live(const char* name, std::function<Value()> read) {
        with(name, [&](const NodeId& node) { return source(node, std::move(read)); });
    }

    void liveFrame(const char* name, const std::function<opcua::ThreeDFrame()>& read) {
        with(name, [&](const NodeId& node) {
            return forEachPart(nodes_, node, [&](const NodeId& variable, Part part) {
                return source(variable, [read, part] { return partOf(read(), part); });
            });
        });
    }

    Result<void> source(const NodeId& node, std::function<Value()> read) {
        return nodes_.setDataSource(node, {[read = std::move(read)](const opcua::Session&) {
                                        return opcua::DataValue{read()};
                                    }});
    }

    const Result<void>& outcome() const noexcept { return outcome_; }

private:
    template <typename Work>
    void with(const char* name, Work work) {
        if (!outcome_) {
            return;
        }
        const auto node = nodes_.find(kinematics_, QualifiedName{index_, name});
        outcome_ = node ? work(*node) : Result<void>(fail(node.error()));
    }

    AddressSpace& nodes_;
    NodeId kinematics_;
    std::uint16_t index_;
    Result<void> outcome_;
};

Result<void> checkLengths(const KinematicsData& data) {
    const auto axes = data.axisCount();
    const bool fit =
        data.joint_frames.size() == axes && data.min_joint_position.size() == axes &&
        data.max_joint_position.size() == axes && data.max_joint_velocity.size() == axes &&
        data.max_joint_acceleration.size() == axes && data.max_joint_jerk.size() == axes;
    if (!fit) {
        return fail(Errc::invalid_argument,
                    "kinematics of " + std::to_string(axes) + " axes: a list has another length");
    }
    return {};
}

void setConstants(KinematicsNodes& kinematics, const KinematicsData& data) {
    kinematics.set("AxisCount", Value::of(static_cast<std::uint32_t>(data.axisCount())));
    kinematics.setFrame("BaseFromFirstJoint", data.base_from_first_joint);
    kinematics.setFrame("LastJointFromFlange", data.last_joint_from_flange);
    kinematics.set("JointFrames", Value::of(data.joint_frames));
    kinematics.set("JointAxes", Value::of(data.joint_axes));
    kinematics.set("MinJointPosition", Value::of(data.min_joint_position));
    kinematics.set("MaxJointPosition", Value::of(data.max_joint_position));
    kinematics.set("MaxJointVelocity", Value::of(data.max_joint_velocity));
    kinematics.set("MaxJointAcceleration", Value::of(data.max_joint_acceleration));
    kinematics.set("MaxJointJerk", Value::of(data.max_joint_jerk));
    kinematics.set("MaxCartesianVelocity", Value::of(data.max_cartesian_velocity));
    kinematics.set("MaxCartesianAcceleration", Value::of(data.max_cartesian_acceleration));
    kinematics.set("MaxCartesianJerk", Value::of(data.max_cartesian_jerk));
    kinematics.set("CycleTime", Value::of(data.cycle_time));
    kinematics.set("ToolFrames", Value::of(data.tool_frames));
}

void wireState(KinematicsNodes& kinematics, const ReadState& state) {
    kinematics.live("ActualJointPosition", [state] { return Value::of(state().joint_position); });
    kinematics.liveFrame("ActualPose", [state] { return state().pose; });
    kinematics.live("SafetyState",
                    [state] { return Value::of(static_cast<std::int32_t>(state().safety_state)); });
    kinematics.live("MissedCycles", [state] { return Value::of(state().missed_cycles); });
}

Result<void> setPayload(AddressSpace& nodes, const NodeId& device, double payload) {
    METIER_ASSIGN(const auto robotics, nodes.namespaceIndex(kOpcRoboticsUri));
    const std::array path{QualifiedName{robotics, "FlangeLoad"}, QualifiedName{robotics, "Mass"}};
    METIER_ASSIGN(const auto mass, nodes.find(device, path));
    return nodes.write(mass, Value::of(payload));
}

/// ActualPosition of the AxisType objects, as far as the motion device has them.
Result<void> wireAxes(AddressSpace& nodes, KinematicsNodes& kinematics, const NodeId& device,
                      const ReadState& state) {
    METIER_ASSIGN(const auto di, nodes.namespaceIndex(kDiUri));
    METIER_ASSIGN(const auto robotics, nodes.namespaceIndex(kOpcRoboticsUri));
    METIER_ASSIGN(const auto axes, nodes.find(device, {robotics, "Axes"}));
    METIER_ASSIGN(auto children, nodes.browse(axes, {opcua::ids::kHasComponent}));
    std::sort(children.begin(), children.end(), [](const auto& left, const auto& right) {
        return left.browse_name < right.browse_name;  // Axis_1 to Axis_8
    });
    for (std::size_t axis = 0; axis < children.size(); ++axis) {
        const std::array path{QualifiedName{di, "ParameterSet"},
                              QualifiedName{robotics, "ActualPosition"}};
        METIER_ASSIGN(const auto position, nodes.find(children[axis].target, path));
        METIER_TRY(kinematics.source(position, [state, axis] {
            const auto positions = state().joint_position;
            return axis < positions.size() ? Value::of(positions[axis]) : Value();
        }));
    }
    return {};
}

}  // namespace

Result<void> publishKinematics(AddressSpace& nodes, const MotionDeviceSystem& system,
                               const KinematicsData& data, ReadState state) {
    METIER_TRY(checkLengths(data));
    METIER_ASSIGN(const auto metier, nodes.namespaceIndex(kMetierUri));
    KinematicsNodes kinematics(nodes, system.kinematics, metier);
    setConstants(kinematics, data);
    wireState(kinematics, state);
    if (!kinematics.outcome()) {
        return kinematics.outcome();
    }
    if (data.payload > 0) {
        METIER_TRY(setPayload(nodes, system.motion_device, data.payload));
    }
    METIER_TRY(wireAxes(nodes, kinematics, system.motion_device, state));
    return publishRobotValues(nodes, system, state);
}

}  // namespace metier::opcua_skill
