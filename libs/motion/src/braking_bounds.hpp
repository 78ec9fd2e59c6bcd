#pragma once

#include <array>
#include <vector>

#include "metier/motion/profile.hpp"
#include "metier/motion/robot_model.hpp"
#include "path.hpp"
#include "speed_map.hpp"

namespace metier::motion {

/// Bounds of how hard a motion may brake along its path: the robot's own limits of its axes and,
/// on a path of the tool frame, of that, whatever limits the motion was planned with.
///
/// Threading: immutable; brake() neither allocates, locks nor throws.
class BrakingBounds {
public:
    BrakingBounds() = default;
    static BrakingBounds of(const RobotModel& model, const JointLine& line);
    static BrakingBounds of(const RobotModel& model, const JointPath& path);

    /// The path parameter's way to rest from `state`, as quick as the limits allow with one
    /// acceleration and one jerk for the whole way.
    /// \param factor the part of the robot's limits that may be used, > 0; above 1 for a Halt
    /// \return may end beyond 1, where the path is too short for these limits
    Profile brake(const ScalarState& state, double factor) const noexcept;

private:
    /// Shares of the robot's limits that derivatives of one axis, or of the tool frame, by the path
    /// parameter use. At velocity v, acceleration a and jerk j of the path parameter a motion uses
    /// first * a + second * v^2 of the acceleration limit, and
    /// jerk_first * j + 3 * jerk_second * v * a + jerk_third * v^3 of that of the jerk.
    struct Share {
        double first = 0;
        double second = 0;  ///< where it adds to the braking
        double jerk_first = 0;
        double jerk_second = 0;
        double jerk_third = 0;
    };
    /// All axes, then the tool frame's translation and rotation.
    using Place = std::array<Share, kMaxAxes + 2>;

    static Share shareOf(const SpeedBound& bound) noexcept;
    Place worst(double from, double to) const noexcept;
    /// How much of the limits may be used.
    struct Use {
        double velocity = 0;    ///< of the path parameter [1/s]
        double factor = 1;      ///< of the robot's limits
        double bend_share = 0;  ///< of the jerk limits, by an acceleration in a bend of the path
    };
    static void narrow(ScalarLimits& limits, const Place& place, const Use& use) noexcept;
    ScalarLimits limitsAlong(const Profile& way, Use use) const noexcept;
    Profile brake(const ScalarState& state, const Use& use) const noexcept;

    std::vector<Place> places_;  ///< at equal steps of the path parameter; one: the same all along
};

}  // namespace metier::motion
