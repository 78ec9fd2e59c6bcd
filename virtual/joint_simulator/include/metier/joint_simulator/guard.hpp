#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "metier/device/joint_array.hpp"

namespace metier::joint_simulator {

/// Limits of one axis in the simulated controller.
struct AxisLimits {
    double lower = 0.0;         ///< [rad]
    double upper = 0.0;         ///< [rad]
    double velocity = 0.0;      ///< [rad/s], > 0
    double acceleration = 0.0;  ///< [rad/s2], > 0; the controller's own stop brakes with it
};

/// Amounts by which a set-point may exceed a limit before the controller stops the arm.
struct GuardTolerance {
    double position = 1e-6;      ///< [rad]
    double velocity = 0.01;      ///< part of the limit
    double acceleration = 0.05;  ///< part of the limit
};

/// A limit that a set-point broke; without text, so that a cycle thread can make it.
struct Violation {
    enum class Quantity : std::uint8_t { position, velocity, acceleration, not_finite, axis_count };

    Quantity quantity = Quantity::position;
    std::size_t axis = 0;  ///< from 0
    double value = 0.0;
    double limit = 0.0;
};

/// A sentence for a person, with axis (from 1), value, limit and unit.
std::string toText(const Violation& violation);

/// Checks each set-point against the last two by finite differences over one cycle, as a real
/// controller does. It shares no code with the motion library, so that it cannot share a mistake
/// with the set-points that it checks.
///
/// Threading: one thread, the cycle. Does not allocate.
class Guard {
public:
    /// \param cycle [s], > 0
    Guard(std::vector<AxisLimits> limits, GuardTolerance tolerance, double cycle);

    /// Takes a set-point, or leaves the guard unchanged and returns the broken limit.
    std::optional<Violation> accept(const device::JointArray& set_point) noexcept;

    /// Brakes each axis by one cycle as hard as its limit allows.
    /// \return the position at the end of the cycle
    const device::JointArray& brake() noexcept;

    /// Sets the arm at a position, standing still.
    void reset(const device::JointArray& position) noexcept;

    const device::JointArray& position() const noexcept { return position_; }  ///< [rad]
    const device::JointArray& velocity() const noexcept { return velocity_; }  ///< [rad/s]
    bool standing() const noexcept;

private:
    std::optional<Violation> check(std::size_t axis, double position,
                                   double velocity) const noexcept;

    std::vector<AxisLimits> limits_;
    GuardTolerance tolerance_;
    double cycle_;
    device::JointArray position_;
    device::JointArray velocity_;
};

}  // namespace metier::joint_simulator
