#include "remote_arm/robotics_arm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <numbers>
#include <optional>
#include <set>
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

/// Each once, however often it is referenced.
Answer<References> partsOf(Questions& questions, const NodeId& node) {
    METIER_ASSIGN(auto parts, questions.browse({.node = node, .node_classes = {}}));
    std::set<NodeId> seen;
    std::erase_if(parts, [&](const Reference& part) { return !seen.insert(part.target).second; });
    return parts;
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

/// The arm that a skill moves.
struct WantedArm {
    const SkillAddress& skill;
    const std::string& device;  // BrowseName; empty: any
};

/// Errors: invalid_argument, if there are several: the position of another arm would be taken.
Answer<> checkOnlyOne(const std::vector<RoboticsArm>& arms, const SkillAddress& skill) {
    std::vector<std::string> names;
    for (const auto& arm : arms) {
        names.push_back(arm.name);
    }
    return arms.size() <= 1
               ? Answer<>()
               : tl::unexpected(failureOf(
                     Errc::invalid_argument,
                     fmt::format(
                         "{} could move any of {}: none of them is above it; choose one by device",
                         skill.name, fmt::join(names, ", "))));
}

/// The arm of a system; nothing if the object is no system with one.
Answer<std::optional<RoboticsArm>> armOf(Questions& questions, const NodeId& system,
                                         const WantedArm& wanted) {
    const auto& skill = wanted.skill;
    METIER_ASSIGN(const auto folder, below(questions, system, {"MotionDevices"}));
    if (folder.isNull()) {
        return std::optional<RoboticsArm>();
    }
    METIER_ASSIGN(auto devices, partsOf(questions, folder));
    const auto own = std::find_if(devices.begin(), devices.end(), [&](const Reference& device) {
        return std::any_of(skill.above.begin(), skill.above.end(),
                           [&](const auto& above) { return above.node == device.target; });
    });
    if (own != devices.end()) {
        devices = {*own};
    }
    std::erase_if(devices, [&](const Reference& device) {
        return !wanted.device.empty() && device.browse_name.name != wanted.device;
    });
    std::vector<RoboticsArm> arms;
    for (const auto& device : devices) {
        METIER_ASSIGN(auto axes, axesOf(questions, device.target));
        if (!axes.empty()) {
            arms.push_back({sanitise(device.browse_name.name), std::move(axes)});
        }
    }
    METIER_TRY(checkOnlyOne(arms, skill));
    if (arms.empty()) {
        return std::optional<RoboticsArm>();
    }
    METIER_TRY(addSafety(questions, system, arms.front()));
    return std::optional(std::move(arms.front()));
}

/// The only arm of the devices of the server.
Answer<std::optional<RoboticsArm>> armOfDevices(Questions& questions, const WantedArm& wanted) {
    METIER_ASSIGN(const auto device_set,
                  below(questions, opcua::ids::kObjectsFolder, {"DeviceSet"}));
    std::vector<RoboticsArm> arms;
    if (!device_set.isNull()) {
        METIER_ASSIGN(const auto devices, partsOf(questions, device_set));
        for (const auto& device : devices) {
            METIER_ASSIGN(auto arm, armOf(questions, device.target, wanted));
            if (arm) {
                arms.push_back(std::move(*arm));
            }
        }
    }
    METIER_TRY(checkOnlyOne(arms, wanted.skill));
    return arms.empty() ? std::optional<RoboticsArm>() : std::optional(std::move(arms.front()));
}

}  // namespace

Answer<RoboticsArm> findRoboticsArm(opcua::Client& client, const SkillAddress& skill,
                                    const std::string& device) {
    Questions questions(client);
    const WantedArm wanted{skill, device};
    for (auto above = skill.above.rbegin(); above != skill.above.rend(); ++above) {
        METIER_ASSIGN(auto arm, armOf(questions, above->node, wanted));
        if (arm) {
            return std::move(*arm);
        }
    }
    METIER_ASSIGN(auto arm, armOfDevices(questions, wanted));
    if (arm) {
        return std::move(*arm);
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
