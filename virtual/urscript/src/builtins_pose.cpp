#include <cmath>

#include "call.hpp"
#include "pose_math.hpp"

namespace metier::urscript {
namespace {

Value poseDistance(Call& call) {
    const Pose from = call.pose(0);
    const Pose difference = subtracted(call.pose(1), from);
    double sum = 0.0;
    for (const double part : difference.value) {
        sum += part * part;
    }
    return std::sqrt(sum);
}

Value pointDistance(Call& call) {
    const Pose from = call.pose(0);
    const Pose to = call.pose(1);
    return std::hypot(to.value[0] - from.value[0], to.value[1] - from.value[1],
                      to.value[2] - from.value[2]);
}

Value listOfThree(const Vector3& values) {
    return std::vector<Value>(values.begin(), values.end());
}

}  // namespace

std::span<const Builtin> poseBuiltins() {
    static constexpr Builtin kAll[] = {
        {"interpolate_pose", "p_from p_to alpha", 3,
         [](Call& call) {
             return Value(interpolated(call.pose(0), call.pose(1), call.number(2)));
         }},
        {"inv", "m", 1, [](Call& call) { return Value(inverted(call.pose(0))); }},
        {"point_dist", "p_from p_to", 2, pointDistance},
        {"pose_add", "p_1 p_2", 2,
         [](Call& call) { return Value(added(call.pose(0), call.pose(1))); }},
        {"pose_dist", "p_from p_to", 2, poseDistance},
        {"pose_inv", "p_from", 1, [](Call& call) { return Value(inverted(call.pose(0))); }},
        {"pose_sub", "p_to p_from", 2,
         [](Call& call) { return Value(subtracted(call.pose(0), call.pose(1))); }},
        {"pose_trans", "p_from p_from_to", 2,
         [](Call& call) { return Value(transformed(call.pose(0), call.pose(1))); }},
        {"rotvec2rpy", "rotation_vector", 1,
         [](Call& call) { return listOfThree(rollPitchYawOf(call.vector3(0))); }},
        {"rpy2rotvec", "rpy_vector", 1,
         [](Call& call) { return listOfThree(rotationVectorOf(call.vector3(0))); }},
    };
    return kAll;
}

}  // namespace metier::urscript
