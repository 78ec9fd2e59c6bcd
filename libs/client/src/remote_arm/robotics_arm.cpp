#include "remote_arm/robotics_arm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "metier/opcua/text.hpp"
#include "questions.hpp"

namespace metier::client {
namespace {

using opcua::Answer;
using opcua::NodeId;
using opcua::Reference;
using opcua::sanitise;
using References = std::vector<Reference>;

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
// Unit numbers of OPC 10000-8, made of the codes of UNECE Recommendation 20: C81 and DD.
constexpr std::int32_t kRadianId = 4'405'297;
constexpr std::int32_t kDegreeId = 17'476;

Answer<References> partsOf(Questions& questions, const NodeId& node) {
    return questions.browse({.node = node, .node_classes = {}});
}

const Reference* partNamed(const References& references, std::string_view name) {
    const auto found = std::find_if(references.begin(), references.end(), [&](const auto& each) {
        return each.browse_name.name == name;
    });
    return found == references.end() ? nullptr : &*found;
}

/// The node at the end of a path of BrowseNames of any namespace; null if there is none.
Answer<NodeId> below(Questions& questions, NodeId node,
                     std::initializer_list<std::string_view> names) {
    for (const auto name : names) {
        METIER_ASSIGN(const auto children, partsOf(questions, node));
        const auto* child = partNamed(children, name);
        if (child == nullptr) {
            return NodeId{};
        }
        node = child->target;
    }
    return node;
}

std::optional<double> radiansIn(const opcua::EuInformation& unit) {
    const auto& symbol = unit.display_name.text;
    if (unit.unit_id == kRadianId || symbol == "rad") {
        return 1.0;
    }
    if (unit.unit_id == kDegreeId || symbol == "deg" || symbol == "\u00b0") {
        return kRadiansPerDegree;
    }
    return std::nullopt;
}

Answer<double> unitOf(Questions& questions, const NodeId& variable, const std::string& name,
                      double preset) {
    METIER_ASSIGN(const auto property, below(questions, variable, {"EngineeringUnits"}));
    if (property.isNull() && preset > 0) {
        return preset;
    }
    const auto value = property.isNull() ? Answer<opcua::Value>() : questions.read(property);
    const auto unit = value ? value->as<opcua::EuInformation>() : Result<opcua::EuInformation>{};
    const auto radians = unit ? radiansIn(*unit) : std::nullopt;
    if (!radians) {
        return tl::unexpected(
            failureOf(Errc::invalid_argument,
                      fmt::format("{}: its EngineeringUnits are neither rad nor degree, but \"{}\"",
                                  name, unit ? sanitise(unit->display_name.text) : "")));
    }
    return *radians;
}

/// The axes of a motion device; none if it is no motion device.
Answer<std::vector<RoboticsAxis>> axesOf(Questions& questions, const NodeId& device) {
    METIER_ASSIGN(const auto folder, below(questions, device, {"Axes"}));
    std::vector<RoboticsAxis> axes;
    if (folder.isNull()) {
        return axes;
    }
    METIER_ASSIGN(const auto children, partsOf(questions, folder));
    for (const auto& child : children) {
        METIER_ASSIGN(const auto position,
                      below(questions, child.target, {"ParameterSet", "ActualPosition"}));
        if (position.isNull()) {
            continue;
        }
        auto name = sanitise(child.browse_name.name);
        METIER_ASSIGN(const auto radians,
                      unitOf(questions, position, name + "/ActualPosition", 0.0));
        axes.push_back({std::move(name), position, radians});
    }
    return axes;
}

Answer<> addSafety(Questions& questions, const NodeId& system, RoboticsArm& arm) {
    METIER_ASSIGN(const auto folder, below(questions, system, {"SafetyStates"}));
    if (folder.isNull()) {
        return {};
    }
    METIER_ASSIGN(const auto states, partsOf(questions, folder));
    for (const auto& state : states) {
        for (const auto& [name, stops] : {std::pair{"EmergencyStop", &arm.emergency_stops},
                                          std::pair{"ProtectiveStop", &arm.protective_stops}}) {
            METIER_ASSIGN(auto node, below(questions, state.target, {"ParameterSet", name}));
            if (!node.isNull()) {
                stops->push_back(std::move(node));
            }
        }
    }
    return {};
}

/// The arm of a system; nothing if the object is no system with one.
Answer<std::optional<RoboticsArm>> armOf(Questions& questions, const NodeId& system,
                                         const SkillAddress& skill) {
    METIER_ASSIGN(const auto folder, below(questions, system, {"MotionDevices"}));
    if (folder.isNull()) {
        return std::optional<RoboticsArm>();
    }
    METIER_ASSIGN(auto devices, partsOf(questions, folder));
    std::stable_partition(devices.begin(), devices.end(), [&](const Reference& device) {
        return std::any_of(skill.above.begin(), skill.above.end(),
                           [&](const auto& above) { return above.node == device.target; });
    });
    for (const auto& device : devices) {
        METIER_ASSIGN(auto axes, axesOf(questions, device.target));
        if (!axes.empty()) {
            RoboticsArm arm{sanitise(device.browse_name.name), std::move(axes)};
            METIER_TRY(addSafety(questions, system, arm));
            return std::optional(std::move(arm));
        }
    }
    return std::optional<RoboticsArm>();
}

/// Objects that may be the system of the skill's arm, the most likely first.
Answer<std::vector<NodeId>> systemsOf(Questions& questions, const SkillAddress& skill) {
    std::vector<NodeId> systems;
    std::transform(skill.above.rbegin(), skill.above.rend(), std::back_inserter(systems),
                   [](const auto& above) { return above.node; });
    METIER_ASSIGN(const auto device_set,
                  below(questions, opcua::ids::kObjectsFolder, {"DeviceSet"}));
    if (!device_set.isNull()) {
        METIER_ASSIGN(const auto devices, partsOf(questions, device_set));
        for (const auto& device : devices) {
            systems.push_back(device.target);
        }
    }
    return systems;
}

}  // namespace

Answer<RoboticsArm> findRoboticsArm(opcua::Client& client, const SkillAddress& skill) {
    Questions questions(client);
    METIER_ASSIGN(const auto systems, systemsOf(questions, skill));
    for (const auto& system : systems) {
        METIER_ASSIGN(auto arm, armOf(questions, system, skill));
        if (arm) {
            return std::move(*arm);
        }
    }
    return tl::unexpected(failureOf(
        Errc::not_found, skill.name +
                             " belongs to no motion device with Axes: where the arm stands is not "
                             "published"));
}

Answer<double> radiansPerUnit(opcua::Client& client, const NodeId& variable,
                              const std::string& name, double preset) {
    Questions questions(client);
    return unitOf(questions, variable, name, preset);
}

}  // namespace metier::client
