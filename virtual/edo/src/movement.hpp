#pragma once

#include <cstdint>
#include <vector>

#include "axes.hpp"
#include "message_types.hpp"
#include "metier/motion/pose.hpp"

namespace metier::virtual_edo {

/// A Cartesian pose on the wire: [mm] and Euler angles about z, y, z [deg].
struct CartesianPose {
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    double a = 0.0;
    double e = 0.0;
    double r = 0.0;

    bool operator==(const CartesianPose&) const = default;
};

motion::Pose toPose(const CartesianPose& wire);
/// e in [0, 180]; a is 0 where only the sum of a and r is defined.
CartesianPose toCartesian(const motion::Pose& pose);

/// A point of a move: joints, a pose, or both.
struct Point {
    std::uint8_t data_type = 0;
    CartesianPose pose{};
    std::uint64_t joints_mask = 0;
    std::vector<double> joints;  ///< may be shorter than the mask says
};

/// A MovementCommand as it came.
struct Movement {
    std::uint8_t command = 0;
    std::uint8_t type = 0;
    std::uint8_t override_percent = 0;
    std::uint8_t delay = 0;  ///< [s], or kFly
    Point target{};
    Point via{};
    CartesianPose tool{};
    CartesianPose frame{};

    /// \param message a whole MovementCommand
    static Movement from(const Json& message);
};

/// A whole CartesianPose or Frame of a message.
CartesianPose cartesianFrom(const Json& message);
/// A whole CartesianPose; numbers that are not finite become null.
Json toJson(const CartesianPose& pose);

}  // namespace metier::virtual_edo
