#include "robot_values.hpp"

#include <vector>

#include "model_ids.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::AddressSpace;
using opcua::BrowsePath;
using opcua::DataValue;
using opcua::NodeId;
using ReadState = std::function<KinematicsState()>;

/// Names of OPC DI and OPC Robotics in one server.
struct Names {
    std::uint16_t di = 0;
    std::uint16_t robotics = 0;

    static Result<Names> of(const AddressSpace& nodes) {
        Names names;
        METIER_ASSIGN(names.di, nodes.namespaceIndex(kDiUri));
        METIER_ASSIGN(names.robotics, nodes.namespaceIndex(kOpcRoboticsUri));
        return names;
    }
    BrowsePath parameter(std::string name) const {
        return {{di, "ParameterSet"}, {robotics, std::move(name)}};
    }
};

/// Objects in a folder.
Result<std::vector<opcua::Reference>> within(const AddressSpace& nodes, const NodeId& parent,
                                             const opcua::QualifiedName& folder) {
    METIER_ASSIGN(const auto found, nodes.find(parent, folder));
    return nodes.browse(found, {opcua::ids::kHasComponent});
}

Result<void> setUnknown(AddressSpace& nodes, const NodeId& object, const BrowsePath& path) {
    METIER_ASSIGN(const auto variable, nodes.find(object, path));
    return nodes.write(variable, DataValue{{}, opcua::status::kBadNoData});
}

/// Makes a Boolean of a SafetyStateType true in one safety state of the controller.
Result<void> serveStop(AddressSpace& nodes, const NodeId& variable, SafetyStateKind kind,
                       const ReadState& state) {
    return nodes.setDataSource(variable, {[state, kind](const opcua::Session&) {
                                   const auto now = state().safety_state;
                                   return now == SafetyStateKind::unknown
                                              ? DataValue{{}, opcua::status::kBadNoCommunication}
                                              : DataValue{opcua::Value::of(now == kind)};
                               }});
}

Result<void> serveSafetyState(AddressSpace& nodes, const Names& names, const NodeId& object,
                              const ReadState& state) {
    METIER_ASSIGN(const auto emergency, nodes.find(object, names.parameter("EmergencyStop")));
    METIER_ASSIGN(const auto protective, nodes.find(object, names.parameter("ProtectiveStop")));
    METIER_TRY(serveStop(nodes, emergency, SafetyStateKind::emergency_stop, state));
    METIER_TRY(serveStop(nodes, protective, SafetyStateKind::protective_stop, state));
    return setUnknown(nodes, object, names.parameter("OperationalMode"));
}

Result<void> serveSafetyStates(AddressSpace& nodes, const Names& names, const NodeId& system,
                               const ReadState& state) {
    METIER_ASSIGN(const auto objects, within(nodes, system, {names.robotics, "SafetyStates"}));
    for (const auto& object : objects) {
        METIER_TRY(serveSafetyState(nodes, names, object.target, state));
    }
    return {};
}

/// The motors of one power train.
Result<void> setMotorsOfTrainUnknown(AddressSpace& nodes, const Names& names, const NodeId& train) {
    METIER_ASSIGN(const auto parts, nodes.browse(train, {opcua::ids::kHasComponent}));
    for (const auto& part : parts) {
        if (part.type_definition == NodeId(names.robotics, kMotorTypeId)) {
            METIER_TRY(setUnknown(nodes, part.target, names.parameter("MotorTemperature")));
        }
    }
    return {};
}

Result<void> setMotorsUnknown(AddressSpace& nodes, const Names& names, const NodeId& device) {
    METIER_ASSIGN(const auto trains, within(nodes, device, {names.robotics, "PowerTrains"}));
    for (const auto& train : trains) {
        METIER_TRY(setMotorsOfTrainUnknown(nodes, names, train.target));
    }
    return {};
}

/// A variable, and the variables that are parts of it.
Result<void> setAllUnknown(AddressSpace& nodes, const NodeId& variable) {
    METIER_TRY(nodes.write(variable, DataValue{{}, opcua::status::kBadNoData}));
    METIER_ASSIGN(const auto parts, nodes.browse(variable, {opcua::ids::kHasComponent}));
    for (const auto& part : parts) {
        METIER_TRY(setAllUnknown(nodes, part.target));
    }
    return {};
}

/// Centre of mass and inertia of the load at the flange: no driver knows them, only the mass.
Result<void> setLoadUnknown(AddressSpace& nodes, const Names& names, const NodeId& device) {
    METIER_ASSIGN(const auto parts, within(nodes, device, {names.robotics, "FlangeLoad"}));
    for (const auto& part : parts) {
        const auto& name = part.browse_name.name;
        if (name == "CenterOfMass" || name == "Inertia") {
            METIER_TRY(setAllUnknown(nodes, part.target));
        }
    }
    return {};
}

/// Programs of the controller itself: no driver asks for them.
Result<void> setTasksUnknown(AddressSpace& nodes, const Names& names, const NodeId& controller) {
    METIER_ASSIGN(const auto tasks, within(nodes, controller, {names.robotics, "TaskControls"}));
    for (const auto& task : tasks) {
        METIER_TRY(setUnknown(nodes, task.target, names.parameter("TaskProgramName")));
        METIER_TRY(setUnknown(nodes, task.target, names.parameter("TaskProgramLoaded")));
    }
    return {};
}

}  // namespace

Result<void> publishRobotValues(AddressSpace& nodes, const MotionDeviceSystem& system,
                                const ReadState& state) {
    METIER_ASSIGN(const auto names, Names::of(nodes));
    METIER_TRY(setUnknown(nodes, system.motion_device, names.parameter("SpeedOverride")));
    METIER_TRY(setMotorsUnknown(nodes, names, system.motion_device));
    METIER_TRY(setLoadUnknown(nodes, names, system.motion_device));
    METIER_TRY(setTasksUnknown(nodes, names, system.controller));
    return serveSafetyStates(nodes, names, system.system, state);
}

}  // namespace metier::opcua_skill
