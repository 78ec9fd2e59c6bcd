#include "remote_arm/stream_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "questions.hpp"
#include "remote_arm/robotics_arm.hpp"
#include "skill_nodes.hpp"

namespace metier::client {
namespace {

using opcua::Answer;

constexpr const char* kJoints = "TargetJointPosition";
constexpr const char* kPose = "TargetPosition";

const FieldNode* parameterOf(const SkillNodes& nodes, std::string_view name,
                             skill::ValueType type) {
    const auto found = std::find_if(
        nodes.parameters.begin(), nodes.parameters.end(),
        [&](const auto& node) { return node.field.name == name && node.field.type == type; });
    return found == nodes.parameters.end() ? nullptr : &*found;
}

tl::unexpected<opcua::Failure> lacks(Errc code, const SkillAddress& skill, std::string_view what) {
    return tl::unexpected(failureOf(code, fmt::format("{} has no {}", skill.name, what)));
}

Answer<> checkEnds(const SkillNodes& nodes, const SkillAddress& skill) {
    for (const auto method : {skill::Method::halt, skill::Method::reset}) {
        if (nodes.methods.at(static_cast<std::size_t>(method)).isNull()) {
            return lacks(Errc::not_supported, skill,
                         fmt::format("{}: its stream could not be ended", toString(method)));
        }
    }
    return {};
}

}  // namespace

skill::Value StreamTarget::valueOf(const device::JointArray& set_point) const {
    if (pose_at) {
        return pose_at(set_point);
    }
    std::vector<double> values(set_point.size());
    for (std::size_t joint = 0; joint < set_point.size(); ++joint) {
        const auto element = places.empty() ? joint : places[joint].element;
        values[element] = set_point[joint] / radians_per_unit;
    }
    return values;
}

Answer<ForeignStream> findForeignStream(opcua::Client& client, const SkillAddress& skill,
                                        StreamTarget preset) {
    METIER_ASSIGN(const auto nodes, readSkillNodes(client, skill));
    METIER_TRY(checkEnds(nodes, skill));
    ForeignStream stream{std::move(preset), nodes.program};
    auto& target = stream.target;
    if (const auto* joints = parameterOf(nodes, kJoints, skill::ValueType::numbers)) {
        METIER_ASSIGN(target.radians_per_unit, radiansPerUnit(client, joints->node, kJoints, 1.0));
        target.pose_at = {};
        return stream;
    }
    if (parameterOf(nodes, kPose, skill::ValueType::frame) == nullptr || !target.pose_at) {
        return lacks(Errc::not_found, skill, fmt::format("{} of Double[]", kJoints));
    }
    target.parameter = kPose;
    return stream;
}

}  // namespace metier::client
