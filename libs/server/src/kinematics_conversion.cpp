#include "metier/server/kinematics_conversion.hpp"

#include <fmt/format.h>

#include "metier/motion/frame.hpp"

namespace metier::server {
namespace {

void addJoint(const motion::JointDescription& joint, opcua_skill::KinematicsData& data) {
    const bool first = data.joint_axes.empty();
    if (first) {
        data.base_from_first_joint = motion::toFrame(joint.parent_from_joint);
    }
    data.joint_frames.push_back(first ? opcua::ThreeDFrame{}
                                      : motion::toFrame(joint.parent_from_joint));
    data.joint_axes.push_back({joint.axis.x(), joint.axis.y(), joint.axis.z()});
    data.min_joint_position.push_back(joint.limits.lower);
    data.max_joint_position.push_back(joint.limits.upper);
    data.max_joint_velocity.push_back(joint.limits.velocity);
    data.max_joint_acceleration.push_back(joint.limits.acceleration);
    data.max_joint_jerk.push_back(joint.limits.jerk);
}

motion::JointDescription jointFrom(const opcua_skill::KinematicsData& data, std::size_t axis) {
    motion::JointDescription joint;
    joint.name = fmt::format("Axis {}", axis + 1);
    joint.parent_from_joint =
        motion::toPose(axis == 0 ? data.base_from_first_joint : data.joint_frames[axis]);
    const auto& direction = data.joint_axes[axis];
    joint.axis = {direction.x, direction.y, direction.z};
    joint.limits = {data.min_joint_position[axis], data.max_joint_position[axis],
                    data.max_joint_velocity[axis], data.max_joint_acceleration[axis],
                    data.max_joint_jerk[axis]};
    return joint;
}

}  // namespace

opcua_skill::KinematicsData toKinematicsData(const motion::RobotModel& model) {
    const auto& chain = model.chain();
    opcua_skill::KinematicsData data;
    for (const auto& joint : chain.joints) {
        addJoint(joint, data);
    }
    data.last_joint_from_flange = motion::toFrame(chain.last_from_flange);
    const auto& limits = chain.cartesian_limits;
    data.max_cartesian_velocity = {limits.velocity, limits.angular_velocity};
    data.max_cartesian_acceleration = {limits.acceleration, limits.angular_acceleration};
    data.max_cartesian_jerk = {limits.jerk, limits.angular_jerk};
    data.cycle_time = chain.cycle_time;
    data.tool_frames = {"flange"};
    for (const auto& tool : chain.tools) {
        if (tool.name != "flange") {
            data.tool_frames.push_back(tool.name);
        }
    }
    return data;
}

Result<motion::ChainDescription> toChain(const opcua_skill::KinematicsData& data,
                                         const std::vector<double>& current) {
    if (data.axisCount() > motion::kMaxAxes) {
        return fail(Errc::not_supported, fmt::format("an arm of {} axes; motion plans for {}",
                                                     data.axisCount(), motion::kMaxAxes));
    }
    METIER_ASSIGN(const auto home, motion::JointVector::from(current));
    motion::ChainDescription chain;
    for (std::size_t axis = 0; axis < data.axisCount(); ++axis) {
        chain.joints.push_back(jointFrom(data, axis));
    }
    chain.last_from_flange = motion::toPose(data.last_joint_from_flange);
    chain.cartesian_limits = {
        data.max_cartesian_velocity[0],     data.max_cartesian_acceleration[0],
        data.max_cartesian_jerk[0],         data.max_cartesian_velocity[1],
        data.max_cartesian_acceleration[1], data.max_cartesian_jerk[1]};
    chain.home = home;
    chain.cycle_time = data.cycle_time;
    return chain;
}

}  // namespace metier::server
