#pragma once

#include "metier/motion/frame.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"

namespace metier::client::testing {

/// Kinematics and limits that the server of an arm publishes.
inline opcua_skill::KinematicsData dataOf(const motion::RobotModel& model) {
    const auto frameOf = [](const motion::Pose& pose) {
        const auto frame = motion::toFrame(pose);
        return opcua::ThreeDFrame{frame.x, frame.y, frame.z, frame.a, frame.b, frame.c};
    };
    const auto& chain = model.chain();
    opcua_skill::KinematicsData data;
    data.base_from_first_joint = frameOf(chain.joints.front().parent_from_joint);
    data.last_joint_from_flange = frameOf(chain.last_from_flange);
    for (const auto& joint : chain.joints) {
        data.joint_frames.push_back(data.joint_frames.empty() ? opcua::ThreeDFrame{}
                                                              : frameOf(joint.parent_from_joint));
        data.joint_axes.push_back({joint.axis.x(), joint.axis.y(), joint.axis.z()});
        data.min_joint_position.push_back(joint.limits.lower);
        data.max_joint_position.push_back(joint.limits.upper);
        data.max_joint_velocity.push_back(joint.limits.velocity);
        data.max_joint_acceleration.push_back(joint.limits.acceleration);
        data.max_joint_jerk.push_back(joint.limits.jerk);
    }
    data.max_cartesian_velocity = {1, 2};
    data.max_cartesian_acceleration = {2, 5};
    data.max_cartesian_jerk = {50, 100};
    data.cycle_time = model.cycleTime();
    data.tool_frames = {"flange"};
    return data;
}

}  // namespace metier::client::testing
