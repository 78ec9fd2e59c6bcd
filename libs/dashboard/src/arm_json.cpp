#include "arm_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "live_values.hpp"
#include "metier/motion/frame.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::dashboard {
namespace {

using motion::RobotModel;
using nlohmann::json;
using opcua_skill::KinematicsData;

json vectorJson(const Eigen::Vector3d& v) {
    return {rounded(v.x()), rounded(v.y()), rounded(v.z())};
}

Frame jointFrame(const KinematicsData& data, std::size_t axis) {
    return axis == 0 ? data.base_from_first_joint : data.joint_frames[axis];
}

/// Distance between two joints; up to 1 they are of the same kind of arm.
double distance(const KinematicsData& data, std::size_t axis,
                const motion::JointDescription& joint) {
    constexpr double kMetres = 0.005;
    constexpr double kRadians = 0.02;
    const auto told = motion::toPose(jointFrame(data, axis));
    const auto& direction = data.joint_axes[axis];
    const Eigen::Vector3d reported_axis =
        told.rotation * Eigen::Vector3d(direction.x, direction.y, direction.z);
    const Eigen::Vector3d axis_of_model = joint.parent_from_joint.rotation * joint.axis;
    return std::max({(told.translation - joint.parent_from_joint.translation).norm() / kMetres,
                     told.rotation.angularDistance(joint.parent_from_joint.rotation) / kRadians,
                     (reported_axis - axis_of_model).norm() / kRadians});
}

json jointsJson(const KinematicsData& data, const RobotModel* model) {
    auto joints = json::array();
    for (std::size_t axis = 0; axis < data.axisCount(); ++axis) {
        const auto& direction = data.joint_axes[axis];
        joints.push_back(
            {{"name", model == nullptr ? fmt::format("Axis {}", axis + 1)
                                       : model->chain().joints[axis].name},
             {"origin", frameJson(jointFrame(data, axis))},
             {"axis", {rounded(direction.x), rounded(direction.y), rounded(direction.z)}},
             {"lower", data.min_joint_position[axis]},
             {"upper", data.max_joint_position[axis]},
             {"velocity", data.max_joint_velocity[axis]}});
    }
    return joints;
}

/// A tool frame that no model knows has no frame here: only its name is published.
json toolsJson(const KinematicsData& data, const RobotModel* model) {
    auto tools = json::array();
    for (const auto& name : data.tool_frames) {
        json tool{{"name", name}, {"frame", nullptr}};
        if (name == "flange") {
            tool["frame"] = frameJson({});
        } else if (const auto known = model == nullptr
                                          ? Result<motion::ToolFrame>(fail(Errc::not_found, ""))
                                          : model->tool(name)) {
            tool["frame"] = frameJson(motion::toFrame(known->flange_from_tool));
        }
        tools.push_back(std::move(tool));
    }
    return tools;
}

json visualsJson(const RobotModel& model) {
    auto visuals = json::array();
    for (const auto& shape : model.visual()) {
        visuals.push_back({{"link", shape.link},
                           {"from", vectorJson(shape.from)},
                           {"to", vectorJson(shape.to)},
                           {"from_radius", shape.from_radius},
                           {"to_radius", shape.to_radius},
                           {"color", shape.color}});
        if (shape.edge >= 0.0) {
            visuals.back()["edge"] = shape.edge;
        }
    }
    return visuals;
}

json capsulesJson(const RobotModel& model) {
    auto capsules = json::array();
    for (const auto& capsule : model.capsules()) {
        capsules.push_back({{"link", capsule.link},
                            {"from", vectorJson(capsule.from)},
                            {"to", vectorJson(capsule.to)},
                            {"radius", capsule.radius}});
    }
    return capsules;
}

}  // namespace

json frameJson(const Frame& frame) {
    return {rounded(frame.x), rounded(frame.y), rounded(frame.z),
            rounded(frame.a), rounded(frame.b), rounded(frame.c)};
}

const RobotModel* modelOf(const KinematicsData& data, const std::vector<RobotModel>& models) {
    const RobotModel* closest = nullptr;
    double least = 1.0;
    for (const auto& model : models) {
        if (model.axisCount() != data.axisCount()) {
            continue;
        }
        double farthest = 0.0;
        for (std::size_t axis = 0; axis < data.axisCount(); ++axis) {
            farthest = std::max(farthest, distance(data, axis, model.chain().joints[axis]));
        }
        if (farthest < least) {
            least = farthest;
            closest = &model;
        }
    }
    return closest;
}

json armJson(const ArmOrigin& origin, const KinematicsData& data,
             const std::vector<RobotModel>& models) {
    const auto* model = modelOf(data, models);
    return {{"key", origin.key},
            {"name", origin.device},
            {"server", origin.server},
            {"model", model == nullptr ? json() : json(model->name())},
            {"maker", model == nullptr ? json("") : json(model->maker())},
            {"product", model == nullptr ? json("") : json(model->product())},
            {"base", frameJson(origin.world_from_base.value_or(Frame{}))},
            {"base_known", origin.world_from_base.has_value()},
            {"joints", jointsJson(data, model)},
            {"flange", frameJson(data.last_joint_from_flange)},
            {"tools", toolsJson(data, model)},
            {"visuals", model == nullptr ? json::array() : visualsJson(*model)},
            {"capsules", model == nullptr ? json::array() : capsulesJson(*model)},
            {"max_velocity", data.max_cartesian_velocity},
            {"payload", data.payload},
            {"cycle_time", data.cycle_time}};
}

}  // namespace metier::dashboard
