#pragma once

#include <algorithm>

#include "metier/device/joint_array.hpp"
#include "metier/geometry/frame.hpp"
#include "metier/geometry/pose.hpp"
#include "metier/motion/joint_vector.hpp"
#include "metier/skill/value.hpp"

namespace metier::robot_skills {

/// The device's joints as motion has them; no more than motion::kMaxAxes of them.
inline motion::JointVector toVector(const device::JointArray& joints) noexcept {
    motion::JointVector vector(std::min(joints.size(), motion::kMaxAxes));
    std::copy_n(joints.begin(), vector.size(), vector.begin());
    return vector;
}

inline device::JointArray toArray(const motion::JointVector& joints) noexcept {
    return device::JointArray(joints.span());
}

inline geometry::Pose poseOf(const skill::Frame& frame) {
    return geometry::toPose(geometry::Frame{frame.x, frame.y, frame.z, frame.a, frame.b, frame.c});
}

inline skill::Frame frameOf(const geometry::Pose& pose) {
    const auto frame = geometry::toFrame(pose);
    return {frame.x, frame.y, frame.z, frame.a, frame.b, frame.c};
}

}  // namespace metier::robot_skills
