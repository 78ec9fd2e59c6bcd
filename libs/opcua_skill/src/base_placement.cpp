#include "metier/opcua_skill/base_placement.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <utility>

#include "metier/opcua/text.hpp"
#include "model_ids.hpp"
#include "node_limits.hpp"
#include "value_part.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::NodeId;
using opcua::QualifiedName;

constexpr const char* kName = "WorldToRobotBase";

/// The value of one server.
struct Placement {
    opcua::Server& server;
    NodeId node;
    skill::Field field{.name = kName, .type = skill::ValueType::frame, .unit = skill::kMetre};
    skill::Value pose = Frame{};
    NodeLimits limits{};
};

Result<skill::Value> checked(const Placement& placement, const opcua::Value& value) {
    METIER_ASSIGN(auto pose, withPart(placement.field, placement.pose, Part::whole, value));
    if (skill::isNull(pose)) {
        return fail(Errc::out_of_range, fmt::format("{}: a value is needed", kName));
    }
    return skill::checkValue(placement.field, pose)
        .and_then([&] { return placement.limits.check(0, placement.field, pose); })
        .map([&] { return pose; });
}

std::string writerIn(const opcua::Session& session) {
    return opcua::sanitise(fmt::format("{} ({}) of \"{}\"",
                                       session.user.empty() ? "somebody" : session.user,
                                       security::toString(session.role), session.application_name));
}

Result<void> write(Placement& placement, const opcua::WriteContext& writer,
                   const opcua::Value& value) {
    auto pose = checked(placement, value);
    const auto who = writerIn(writer.session);
    placement.server.audit(
        {.object = placement.node,
         .event = "Write",
         .text = pose ? fmt::format("{} wrote {}", who, skill::toString(*pose))
                      : fmt::format("{} was refused: {}", who, pose.error().message)});
    if (!pose) {
        return fail(std::move(pose.error()));
    }
    placement.pose = std::move(*pose);
    return {};
}

Result<NodeId> nodeOf(const opcua::AddressSpace& nodes, const NodeId& motion_device) {
    METIER_ASSIGN(const auto di, nodes.namespaceIndex(kDiUri));
    METIER_ASSIGN(const auto robotics, nodes.namespaceIndex(kRoboticsUri));
    const std::array path{QualifiedName{di, "ParameterSet"}, QualifiedName{robotics, kName}};
    return nodes.find(motion_device, path);
}

}  // namespace

Result<void> serveBasePlacement(opcua::Server& server, const MotionDeviceSystem& system) {
    auto& nodes = server.nodes();
    METIER_ASSIGN(const auto node, nodeOf(nodes, system.motion_device));
    // Shared by the functions of the frame's nodes, on the server's thread.
    const auto placement = std::make_shared<Placement>(Placement{server, node});
    return forEachPart(nodes, node, [&](const NodeId& variable, Part part) {
        placement->limits.add(nodes, variable,
                              {NodeKind::parameter, static_cast<std::uint8_t>(part), 0});
        opcua::DataSource source{[placement, part](const opcua::Session& /*reader*/) {
            return opcua::DataValue{partOf(placement->pose, part)};
        }};
        if (part == Part::whole) {
            source.write = [placement](const opcua::WriteContext& writer,
                                       const opcua::Value& value) {
                return write(*placement, writer, value);
            };
        }
        return nodes.setDataSource(variable, std::move(source));
    });
}

}  // namespace metier::opcua_skill
