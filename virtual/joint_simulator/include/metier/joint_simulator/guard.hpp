#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "metier/device/joint_array.hpp"

namespace metier::joint_simulator {

/// Limits of one axis in the simulated controller.
/// The simulator checks them, JointSimulator::create() refuses limits that are none.
struct AxisLimits {
    /// Lowest position [rad].
    double lower = 0.0;
    /// Highest position [rad].
    double upper = 0.0;
    /// Largest |velocity| [rad/s], > 0.
    double velocity = 0.0;
    /// Largest |acceleration| [rad/s2], > 0; the controller's own stop brakes with it.
    double acceleration = 0.0;
};

/// Amounts by which a set-point may exceed a limit before the controller stops the arm.
struct GuardTolerance {
    /// Amount for positions [rad].
    double position = 1e-6;
    /// Amount for velocities, as a part of the limit.
    double velocity = 0.01;
    /// Amount for accelerations, as a part of the limit.
    double acceleration = 0.05;
};

/// A limit that a set-point broke; without text, so that a cycle thread can make it.
/// A value: copied between threads, formatted by toText() where memory may be allocated.
struct Violation {
    /// Quantity that is beyond its limit.
    /// In the order in which each axis is checked, after the number of axes and whether it is
    /// finite.
    enum class Quantity : std::uint8_t { position, velocity, acceleration, not_finite, axis_count };

    /// The first quantity found.
    Quantity quantity = Quantity::position;
    /// Axis, from 0; not used for axis_count.
    std::size_t axis = 0;
    /// Value of the set-point [rad], [rad/s] or [rad/s2]; for axis_count, its number of axes.
    double value = 0.0;
    /// Limit that it broke, in the same unit.
    double limit = 0.0;
};

/// A sentence for a person, with axis (from 1), value, limit and unit. Allocates. Threads: any;
/// pure.
std::string toText(const Violation& violation);

/// Checks each set-point against the last two by finite differences over one cycle, as a real
/// controller does. It shares no code with the motion library, so that it cannot share a mistake
/// with the set-points that it checks.
///
/// Threading: one thread, the cycle. Does not allocate.
///
///     Guard guard(limits, {}, 0.008);
///     guard.reset(start);
///     if (const auto broken = guard.accept(set_point)) { log(toText(*broken)); }
///
/// The first set-point after reset() is checked against an arm that stands still, so a jump there
/// is too fast as well.
class Guard {
public:
    /// Begins at zero, standing still: call reset().
    /// \param limits one per axis
    /// \param cycle  [s], > 0
    /// \param tolerance amounts that are still accepted; rounding alone needs some
    Guard(std::vector<AxisLimits> limits, GuardTolerance tolerance, double cycle);

    /// Takes a set-point [rad], or leaves the guard unchanged and returns the broken limit.
    /// Axes are checked in order and the first broken limit is returned: position before velocity
    /// before acceleration.
    /// \return nothing if the set-point was taken
    std::optional<Violation> accept(const device::JointArray& set_point) noexcept;

    /// Brakes each axis by one cycle as hard as its limit allows.
    /// Position limits are not watched: an arm that brakes too late passes them. Call it once per
    /// cycle until standing().
    /// \return the position at the end of the cycle
    const device::JointArray& brake() noexcept;

    /// Sets the arm at a position, standing still.
    /// \param position [rad], one value per axis; its limits are not checked
    void reset(const device::JointArray& position) noexcept;

    /// Position of the last set-point or cycle of braking [rad].
    const device::JointArray& position() const noexcept { return position_; }
    /// Velocity at that time, by the difference over one cycle [rad/s].
    const device::JointArray& velocity() const noexcept { return velocity_; }
    /// Whether no axis moves.
    /// Exact: every velocity is 0, as it is after enough calls of brake().
    bool standing() const noexcept;

private:
    std::optional<Violation> check(std::size_t axis, double position,
                                   double velocity) const noexcept;

    // position_ and velocity_ are those of the last accepted set-point, and together with it decide
    // what the next one may be.
    std::vector<AxisLimits> limits_;
    GuardTolerance tolerance_;
    double cycle_;
    device::JointArray position_;
    device::JointArray velocity_;
};

}  // namespace metier::joint_simulator
