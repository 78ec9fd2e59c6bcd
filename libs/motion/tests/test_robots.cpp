#include "test_robots.hpp"

#include "metier/geometry/rotation.hpp"

namespace metier::motion {

double poseError(const geometry::Pose& a, const geometry::Pose& b) {
    return std::max(geometry::distanceBetween(a, b),
                    geometry::rotationAngleBetween(a.rotation, b.rotation));
}

}  // namespace metier::motion
