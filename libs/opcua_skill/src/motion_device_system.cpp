#include "metier/opcua_skill/motion_device_system.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "metier/opcua_skill/skill_controller.hpp"
#include "metier/opcua_skill/values.hpp"
#include "model_ids.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::AddressSpace;
using opcua::NodeId;
using opcua::QualifiedName;
using opcua::Reference;
using opcua::Value;

constexpr std::uint32_t kMotionDeviceSystemType = 1002;
constexpr std::uint32_t kControllerType = 1003;
constexpr std::uint32_t kSoftwareType = 15106;
constexpr std::uint32_t kAxisType = 16601;
constexpr std::uint32_t kPowerTrainType = 16794;
constexpr std::uint32_t kTaskControlType = 1011;
constexpr std::uint32_t kSafetyStateType = 1013;
constexpr std::uint32_t kControls = 4002;
constexpr std::uint32_t kMoves = 18178;
constexpr std::uint32_t kHasSafetyStates = 18182;
constexpr std::uint32_t kSkillMotionDeviceType = 15857;
constexpr std::int32_t kArticulatedRobot = 1;
constexpr std::int32_t kRotary = 1;
/// Unit of the temperature of a motor.
constexpr skill::Unit kDegreeCelsius{"°C", "degree Celsius", "CEL"};

/// Indices of the namespaces that a motion device system is made of.
struct Namespaces {
    std::uint16_t di = 0;
    std::uint16_t opc_robotics = 0;
    std::uint16_t device = 0;
    std::uint16_t robotics = 0;
    std::uint16_t metier = 0;

    static Result<Namespaces> of(const AddressSpace& nodes) {
        Namespaces result;
        const std::array<std::pair<std::string_view, std::uint16_t*>, 5> wanted{{
            {kDiUri, &result.di},
            {kOpcRoboticsUri, &result.opc_robotics},
            {kDeviceUri, &result.device},
            {kRoboticsUri, &result.robotics},
            {kMetierUri, &result.metier},
        }};
        for (const auto& [uri, index] : wanted) {
            METIER_ASSIGN(*index, nodes.namespaceIndex(uri));
        }
        return result;
    }
};

Result<NodeId> firstOfType(const AddressSpace& nodes, const NodeId& parent, const NodeId& type) {
    METIER_ASSIGN(auto children, nodes.browse(parent));
    for (const auto& child : children) {
        if (child.type_definition == type) {
            return child.target;
        }
    }
    return fail(Errc::not_found,
                fmt::format("nothing of type {} below {}", type.toString(), parent.toString()));
}

/// Runs steps in order until one fails, and keeps the first error.
class Steps {
public:
    explicit Steps(AddressSpace& nodes) : nodes_(nodes) {}

    NodeId object(opcua::ObjectSpec spec) { return take(nodes_.addObject(spec)); }
    NodeId find(const NodeId& start, const QualifiedName& child) {
        return take(nodes_.find(start, child));
    }
    void reference(const NodeId& source, const NodeId& type, const NodeId& target) {
        check([&] { return nodes_.addReference(source, type, target); });
    }
    void write(const NodeId& variable, const Value& value) {
        check([&] { return nodes_.write(variable, value); });
    }
    template <typename Work>
    void check(Work work) {
        if (outcome_) {
            outcome_ = work();
        }
    }
    const Result<void>& outcome() const noexcept { return outcome_; }
    AddressSpace& nodes() noexcept { return nodes_; }

private:
    NodeId take(Result<NodeId> id) {
        if (id) {
            return std::move(*id);
        }
        if (outcome_) {
            outcome_ = fail(std::move(id.error()));
        }
        return {};
    }

    AddressSpace& nodes_;
    Result<void> outcome_;
};

opcua::ObjectSpec objectSpec(const NodeId& parent, QualifiedName name, NodeId type,
                             std::string description) {
    return {.node = {.parent = parent,
                     .browse_name = std::move(name),
                     .description = {"en", std::move(description)}},
            .type = std::move(type)};
}

/// Makes the objects of one robot.
class SystemMaker {
public:
    SystemMaker(AddressSpace& nodes, const MotionDeviceSystemSpec& spec, const Namespaces& index)
        : steps_(nodes), spec_(spec), index_(index) {}

    Result<MotionDeviceSystem> make() {
        MotionDeviceSystem made;
        made.system = addSystem();
        addMotionDevice(made);
        addController(made);
        addSafetyState(made);
        steps_.reference(opcua::ids::kServer, opcua::ids::kHasNotifier, made.system);
        steps_.reference(made.system, opcua::ids::kHasNotifier, made.controller);
        steps_.reference(made.controller, NodeId(index_.opc_robotics, kControls),
                         made.motion_device);
        if (!steps_.outcome()) {
            return fail(steps_.outcome().error());
        }
        return made;
    }

private:
    QualifiedName own(std::string name) const { return {spec_.namespace_index, std::move(name)}; }

    NodeId addSystem() {
        auto system =
            objectSpec(NodeId(index_.di, kDeviceSetId), own(spec_.name),
                       NodeId(index_.opc_robotics, kMotionDeviceSystemType), spec_.description);
        system.node.id = NodeId(spec_.namespace_index, spec_.name);
        system.event_notifier = opcua::EventNotifier::subscribable;
        return steps_.object(std::move(system));
    }

    void addMotionDevice(MotionDeviceSystem& made) {
        const auto folder = steps_.find(made.system, {index_.opc_robotics, "MotionDevices"});
        made.motion_device =
            steps_.object(objectSpec(folder, own(spec_.name + "Arm"),
                                     NodeId(index_.robotics, kSkillMotionDeviceType), "The arm."));
        tellMaker(made.motion_device);
        steps_.write(steps_.find(made.motion_device, {index_.opc_robotics, "MotionDeviceCategory"}),
                     Value::of(kArticulatedRobot));
        const auto axes = steps_.find(made.motion_device, {index_.opc_robotics, "Axes"});
        const auto trains = steps_.find(made.motion_device, {index_.opc_robotics, "PowerTrains"});
        for (std::size_t axis = 0; axis < spec_.axis_names.size(); ++axis) {
            addPowerTrain(trains, axis, addAxis(axes, axis));
        }
        made.kinematics = addKinematics(made.motion_device);
    }

    NodeId addAxis(const NodeId& axes, std::size_t axis) {
        auto spec = objectSpec(axes, own(fmt::format("Axis_{}", axis + 1)),
                               NodeId(index_.opc_robotics, kAxisType),
                               fmt::format("Axis {} of the arm, counted from the base.", axis + 1));
        spec.node.display_name = {"", spec_.axis_names[axis]};
        auto node = steps_.object(std::move(spec));
        steps_.write(steps_.find(node, {index_.opc_robotics, "MotionProfile"}), Value::of(kRotary));
        const auto parameters = steps_.find(node, {index_.di, "ParameterSet"});
        const auto position = steps_.find(parameters, {index_.opc_robotics, "ActualPosition"});
        steps_.write(steps_.find(position, {0, "EngineeringUnits"}),
                     Value::of(toOpcua(skill::kRadian)));
        return node;
    }

    /// Adds a power train with one motor, which moves one axis.
    void addPowerTrain(const NodeId& trains, std::size_t axis, const NodeId& moved) {
        const auto number = axis + 1;
        const auto train =
            steps_.object(objectSpec(trains, own(fmt::format("PowerTrain_{}", number)),
                                     NodeId(index_.opc_robotics, kPowerTrainType),
                                     fmt::format("Drive of axis {}.", number)));
        const auto motor =
            steps_.object(objectSpec(train, own("Motor"), NodeId(index_.opc_robotics, kMotorTypeId),
                                     fmt::format("Motor of axis {}.", number)));
        const auto parameters = steps_.find(motor, {index_.di, "ParameterSet"});
        const auto temperature = steps_.find(parameters, {index_.opc_robotics, "MotorTemperature"});
        steps_.write(steps_.find(temperature, {0, "EngineeringUnits"}),
                     Value::of(toOpcua(kDegreeCelsius)));
        steps_.reference(train, NodeId(index_.opc_robotics, kMoves), moved);
    }

    NodeId addKinematics(const NodeId& motion_device) {
        const QualifiedName name{index_.metier, "Kinematics"};
        const auto declared = steps_.find(NodeId(index_.robotics, kSkillMotionDeviceType), name);
        NodeId type;
        steps_.check([&]() -> Result<void> {
            auto types = nodes().browse(declared, {opcua::ids::kHasTypeDefinition});
            if (!types || types->empty()) {
                return fail(Errc::not_found, "the server has no KinematicsType");
            }
            type = types->front().target;
            return {};
        });
        return steps_.object(objectSpec(motion_device, name, type,
                                        "Kinematic chain, limits and live state of the arm."));
    }

    void addController(MotionDeviceSystem& made) {
        const auto folder = steps_.find(made.system, {index_.opc_robotics, "Controllers"});
        auto controller = objectSpec(folder, own(spec_.name + "Controller"),
                                     NodeId(index_.opc_robotics, kControllerType),
                                     "The controller of the arm, with its skills.");
        controller.event_notifier = opcua::EventNotifier::subscribable;
        made.controller = steps_.object(std::move(controller));
        tellMaker(made.controller);
        addSoftware(made.controller);
        addTaskControl(made.controller);
        steps_.check([&]() -> Result<void> {
            METIER_ASSIGN(made.skills, makeSkillController(nodes(), made.controller));
            return {};
        });
    }

    void addSoftware(const NodeId& controller) {
        const auto folder = steps_.find(controller, {index_.opc_robotics, "Software"});
        const auto software = steps_.object(objectSpec(folder, own("ControllerSoftware"),
                                                       NodeId(index_.di, kSoftwareType),
                                                       "Software of the controller."));
        steps_.write(steps_.find(software, {index_.di, "Manufacturer"}),
                     Value::of(opcua::LocalizedText{"en", spec_.manufacturer}));
    }

    void addTaskControl(const NodeId& controller) {
        const auto folder = steps_.find(controller, {index_.opc_robotics, "TaskControls"});
        const auto task = steps_.object(objectSpec(folder, own("SkillControl"),
                                                   NodeId(index_.opc_robotics, kTaskControlType),
                                                   "What runs on the controller for the skills."));
        steps_.write(steps_.find(task, {index_.di, "ComponentName"}),
                     Value::of(opcua::LocalizedText{"en", "SkillControl"}));
    }

    void addSafetyState(const MotionDeviceSystem& made) {
        const auto folder = steps_.find(made.system, {index_.opc_robotics, "SafetyStates"});
        const auto safety = steps_.object(
            objectSpec(folder, own("SafetyState"), NodeId(index_.opc_robotics, kSafetyStateType),
                       "Safety state of the controller, as observed."));
        steps_.reference(made.controller, NodeId(index_.opc_robotics, kHasSafetyStates), safety);
    }

    void tellMaker(const NodeId& component) {
        steps_.write(steps_.find(component, {index_.di, "Manufacturer"}),
                     Value::of(opcua::LocalizedText{"en", spec_.manufacturer}));
        steps_.write(steps_.find(component, {index_.di, "Model"}),
                     Value::of(opcua::LocalizedText{"en", spec_.model}));
    }

    AddressSpace& nodes() { return steps_.nodes(); }

    Steps steps_;
    const MotionDeviceSystemSpec& spec_;
    const Namespaces& index_;
};

}  // namespace

Result<MotionDeviceSystem> findMotionDeviceSystem(const AddressSpace& nodes) {
    METIER_ASSIGN(const auto index, Namespaces::of(nodes));
    METIER_ASSIGN(const auto system,
                  firstOfType(nodes, NodeId(index.di, kDeviceSetId),
                              NodeId(index.opc_robotics, kMotionDeviceSystemType)));
    METIER_ASSIGN(const auto devices, nodes.find(system, {index.opc_robotics, "MotionDevices"}));
    METIER_ASSIGN(const auto controllers, nodes.find(system, {index.opc_robotics, "Controllers"}));
    METIER_ASSIGN(const auto device,
                  firstOfType(nodes, devices, NodeId(index.robotics, kSkillMotionDeviceType)));
    METIER_ASSIGN(const auto controller,
                  firstOfType(nodes, controllers, NodeId(index.opc_robotics, kControllerType)));
    METIER_ASSIGN(const auto skills, nodes.find(controller, {index.device, "Skills"}));
    METIER_ASSIGN(const auto kinematics, nodes.find(device, {index.metier, "Kinematics"}));
    return MotionDeviceSystem{system, device, controller, skills, kinematics};
}

Result<MotionDeviceSystem> publishMotionDeviceSystem(AddressSpace& nodes,
                                                     const MotionDeviceSystemSpec& spec) {
    METIER_ASSIGN(const auto index, Namespaces::of(nodes));
    return SystemMaker(nodes, spec, index).make();
}

}  // namespace metier::opcua_skill
