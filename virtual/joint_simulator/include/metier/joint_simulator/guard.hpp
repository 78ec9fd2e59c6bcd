#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "metier/device/joint_array.hpp"

namespace metier::joint_simulator {

/// What the simulated controller allows one axis.
struct AxisLimits {
    double lower = 0.0;         ///< [rad]
    double upper = 0.0;         ///< [rad]
    double velocity = 0.0;      ///< [rad/s], > 0
    double acceleration = 0.0;  ///< [rad/s2], > 0; also how hard it brakes by itself
};

/// How far a set-point may exceed a limit before the controller stops the arm.
struct GuardTolerance {
    double position = 1e-6;      ///< [rad]
    double velocity = 0.01;      ///< part of the limit
    double acceleration = 0.05;  ///< part of the limit
};

/// What a set-point broke, without text so that a cycle thread can make it.
struct Violation {
    enum class Quantity : std::uint8_t { position, velocity, acceleration, not_finite, axis_count };

    Quantity quantity = Quantity::position;
    std::size_t axis = 0;  ///< from 0
    double value = 0.0;
    double limit = 0.0;
};

/// A sentence with axis (from 1), value, limit and unit.
std::string toText(const Violation& violation);

/// Judges each set-point against the last two, as a real controller does: finite differences over
/// one cycle. Written for this simulator alone, so that it cannot share a mistake with the motion
/// library whose set-points it judges.
///
/// Threading: one thread, the cycle. Does not allocate.
class Guard {
public:
    /// \param cycle [s], > 0
    Guard(std::vector<AxisLimits> limits, GuardTolerance tolerance, double cycle);

    /// Takes a set-point, or leaves the guard unchanged and says what it breaks.
    std::optional<Violation> accept(const device::JointArray& set_point) noexcept;

    /// Brakes each axis by one cycle as hard as its limit allows.
    /// \return the position at the end of the cycle
    const device::JointArray& brake() noexcept;

    /// Puts the arm elsewhere, standing.
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
