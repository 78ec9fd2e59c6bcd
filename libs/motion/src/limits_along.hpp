#pragma once

#include <array>
#include <vector>

#include "metier/motion/profile.hpp"
#include "metier/motion/robot_model.hpp"
#include "path.hpp"
#include "speed_bounds.hpp"

namespace metier::motion {

/// Limits of a parameter along a path (the path parameter or the clock): how hard it may speed up
/// and brake at each place so that axes and tool frame keep their limits.
///
/// Threading: immutable; brake() and toRest() neither allocate, lock nor throw.
class LimitsAlong {
public:
    /// Shares of a limit that the derivatives of one axis, or of the tool frame, by the parameter
    /// use. At velocity v, acceleration a and jerk j of the parameter a motion uses
    /// first * a + second * v^2 of the acceleration limit, and
    /// jerk_first * j + 3 * jerk_second * v * a + jerk_third * v^3 of that of the jerk.
    struct Share {
        double first = 0;
        double second = 0;
        double jerk_first = 0;
        double jerk_second = 0;
        double jerk_third = 0;
    };
    /// All axes, then the tool frame's translation and rotation.
    using Place = std::array<Share, kMaxAxes + 2>;

    LimitsAlong() = default;
    /// The same all along.
    explicit LimitsAlong(const Place& everywhere) : places_{everywhere} {}
    /// \param at where the places are, rising
    LimitsAlong(std::vector<double> at, std::vector<Place> places)
        : at_(std::move(at)), places_(std::move(places)) {}
    /// The robot's own limits along the path parameter, independent of the limits of the plan.
    static LimitsAlong ofRobot(const RobotModel& model, const JointLine& line);
    static LimitsAlong ofRobot(const RobotModel& model, const JointPath& path);
    static Share shareOf(const SpeedBound& bound) noexcept;

    /// The parameter's way to rest from `state`, as quick as the limits allow with one acceleration
    /// and one jerk for the whole way.
    /// \param factor the part of the limits that may be used, > 0; above 1 for a Halt
    /// \param end that it does not go beyond, even where it has to brake harder for it
    /// \return may end beyond the last place, where the way is too short for these limits
    Profile brake(const ScalarState& state, double factor, double end) const noexcept;
    /// The way to rest at `target`, not beyond it, at most `velocity` fast: quick where it speeds
    /// up and brakes.
    Profile toRest(const ScalarState& state, double target, double velocity) const noexcept;
    /// The same for a motion that takes `factor` times as long.
    LimitsAlong slowed(double factor) const;

private:
    /// Share of the limits that may be used.
    struct Use {
        double velocity = 0;    ///< speed of the parameter [1/s]
        double factor = 1;      ///< multiple of the limits
        double bend_share = 0;  ///< share of the remaining jerk for an acceleration in a bend
    };

    Place worst(double from, double to) const noexcept;
    static void narrow(ScalarLimits& limits, const Place& place, const Use& use) noexcept;
    ScalarLimits limitsAt(const ScalarState& state, const Use& use) const noexcept;
    /// Limits that hold wherever `way` speeds up or brakes.
    ScalarLimits limitsOf(const Profile& way, Use use) const noexcept;
    template <typename Plan>
    Profile settle(const ScalarState& state, const Use& use, const Plan& plan) const noexcept;
    template <typename Plan>
    Profile quickest(const ScalarState& state, double factor, const Plan& plan) const noexcept;

    std::vector<double> at_;
    std::vector<Place> places_;  ///< one: the same all along
};

}  // namespace metier::motion
