#pragma once

#include <array>
#include <vector>

#include "metier/motion/planner.hpp"
#include "speed_bounds.hpp"
#include "tool_path.hpp"

namespace metier::motion {

/// The robot's own limit, or a lower one that was asked for; 0 asks for nothing.
inline double capped(double requested, double own) noexcept {
    return requested > 0 && requested < own ? requested : own;
}

/// Largest velocity and acceleration of the tool frame, and of its rotation.
struct ToolLimits {
    double velocity = 0;              ///< [m/s]
    double acceleration = 0;          ///< [m/s2]
    double angular_velocity = 0;      ///< [rad/s]
    double angular_acceleration = 0;  ///< [rad/s2]
};
/// The robot's own where the request limits components of a vector by different values.
ToolLimits toolLimitsOf(const RobotModel& model, const LinRequest& request);
/// Those of a path with corners between two knots, the higher ones of both.
/// \param axes number of the robot's axes; \param bounds with what addToolBounds() added
ToolLimits toolLimitsBetween(const SpeedBounds& a, const SpeedBounds& b, std::size_t axes);
/// Factor by which the tool frame has to be slower to keep its limits; up to 1: it keeps them.
/// \param poses three in a row, `step` [s] apart
double toolExcess(const std::array<Pose, 3>& poses, double step, const ToolLimits& limits);

/// Limits of the path parameter on a single line.
ScalarLimits limitsOfLine(const RobotModel& model, const LinRequest& request, const ToolPath& line);

/// Adds what the tool frame may do at the knots of a path with corners.
/// \return the largest speed of the path parameter that it allows anywhere [1/s]
double addToolBounds(const RobotModel& model, const PathRequest& request, const JointPath& path,
                     std::vector<SpeedBounds>& bounds);

}  // namespace metier::motion
