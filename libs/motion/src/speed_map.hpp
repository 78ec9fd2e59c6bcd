#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "metier/motion/profile.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::motion {

/// Path parameter as a function of the clock: ds/dclock is the fastest the axes allow at s, so one
/// jerk-limited profile of the clock, at most 1 fast, is within every limit of axes and tool frame.
class SpeedMap {
public:
    /// The whole path at one speed. \param speed of the path parameter [1/s], > 0
    static SpeedMap constant(double speed);
    /// \param speed at equal steps of the path parameter, > 0; \param slope its d(speed^2/2)/ds
    static SpeedMap varying(const std::vector<double>& speed, const std::vector<double>& slope);

    double end() const noexcept { return end_; }
    /// s, ds/dclock and d2s/dclock2.
    ScalarState at(double clock) const noexcept;
    /// The clock where the path parameter is `s`, 0 to 1.
    double clockAt(double s) const noexcept;

private:
    struct Node {
        double clock = 0;
        ScalarState s;
    };
    double speed_ = 1;
    double end_ = 0;
    std::vector<Node> nodes_;
};

/// How fast a path may be run.
struct SpeedPlan {
    SpeedMap map;
    ScalarLimits limits;  ///< of the clock; velocity is 1
};

/// What bounds the speed at one place of the path: absolute derivatives by the path parameter of an
/// axis or of the tool frame, and the limits of the same by time.
struct SpeedBound {
    double first = 0;
    double second = 0;
    double third = 0;
    double velocity = 0;
    double acceleration = 0;
    double jerk = 0;
};

/// All bounds at one place; the first ones are the axes'.
struct SpeedBounds {
    std::array<SpeedBound, kMaxAxes + 2> values;
    std::size_t count = 0;
};

/// Bounds of the axes for joint positions at equal steps of the path parameter.
std::vector<SpeedBounds> axisBounds(const RobotModel& model, const std::vector<JointVector>& knots);

/// The axis that holds the path back most.
struct SpeedBottleneck {
    double share = 1;  ///< of the requested speed that the slowest place allows
    std::size_t axis = 0;
    double fraction = 0;
};
SpeedBottleneck findBottleneck(const RobotModel& model, const std::vector<SpeedBounds>& bounds,
                               double speed);

/// \param requested limits of the path parameter for the whole path [1/s], [1/s2], [1/s3]
SpeedPlan planSpeed(const std::vector<SpeedBounds>& bounds, const ScalarLimits& requested);

}  // namespace metier::motion
