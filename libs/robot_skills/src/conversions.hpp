#pragma once

#include <algorithm>

#include "metier/device/joint_array.hpp"
#include "metier/motion/joint_vector.hpp"

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

}  // namespace metier::robot_skills
