#include "test_robots.hpp"

#include "metier/motion/rotation.hpp"

namespace metier::motion {

double poseError(const motion::Pose& a, const motion::Pose& b) {
    return std::max(motion::distanceBetween(a, b),
                    motion::rotationAngleBetween(a.rotation, b.rotation));
}

}  // namespace metier::motion
