#include "metier/motion/frame.hpp"

#include <algorithm>
#include <cmath>

namespace metier::motion {

Pose toPose(const Frame& frame) {
    using Eigen::AngleAxisd;
    using Eigen::Vector3d;
    const Eigen::Quaterniond rotation = AngleAxisd(frame.c, Vector3d::UnitZ()) *
                                        AngleAxisd(frame.b, Vector3d::UnitY()) *
                                        AngleAxisd(frame.a, Vector3d::UnitX());
    return {Vector3d(frame.x, frame.y, frame.z), rotation.normalized()};
}

Frame toFrame(const Pose& pose) {
    // Below this cosine of b, a and c cannot be separated: the matrix entries are rounding noise.
    constexpr double gimbal_lock = 1e-12;
    const Eigen::Matrix3d r = pose.rotation.normalized().toRotationMatrix();
    Frame frame{pose.translation.x(), pose.translation.y(), pose.translation.z()};
    const double cos_b = std::hypot(r(0, 0), r(1, 0));
    frame.b = std::atan2(-r(2, 0), cos_b);
    if (cos_b > gimbal_lock) {
        // a from what remains without c: near gimbal lock it takes up the rounding of c.
        frame.c = std::atan2(r(1, 0), r(0, 0));
        const double cos_c = std::cos(frame.c);
        const double sin_c = std::sin(frame.c);
        frame.a = std::atan2(sin_c * r(0, 2) - cos_c * r(1, 2), cos_c * r(1, 1) - sin_c * r(0, 1));
    } else {
        frame.c = std::atan2(-r(0, 1), r(1, 1));
    }
    return frame;
}

}  // namespace metier::motion
