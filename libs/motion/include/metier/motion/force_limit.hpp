#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "metier/base/error.hpp"
#include "metier/motion/trajectory.hpp"
#include "metier/motion/wrench.hpp"

namespace metier::motion {

/// Largest force and torque with which an arm may press; 0: no limit.
struct WrenchLimits {
    double force = 0;   ///< length of the force [N]
    double torque = 0;  ///< length of the torque [Nm]
    /// Force along x, y, z [N], then torque about x, y, z [Nm], in the frame of the wrench.
    std::array<double, 6> components{};
};

/// A limit that the filtered wrench exceeds.
struct ForceExcess {
    enum class Quantity { force, torque, component, not_finite };
    Quantity quantity = Quantity::force;
    std::size_t component = 0;  ///< 0 to 5 as in WrenchLimits; for component and not_finite
    double value = 0;           ///< [N] or [Nm]
    double limit = 0;
};
/// Error text for a person, with quantity, value, limit and unit. Allocates.
Error toError(const ForceExcess& excess);

/// Watches the wrench of a force-limited motion. The caller acts on an excess: it calls
/// MotionRun::halt() in the same cycle.
///
/// The wrench passes a first-order low-pass of 20 Hz that starts at the first value: a steady
/// wrench below a limit is never an excess, one above it becomes an excess within a few cycles. A
/// value that is not finite is an excess at once, so that a failed sensor is not taken for a small
/// force.
/// Threading: one thread, the control cycle. Checking does not allocate, lock or throw.
/// Source: docs/motion.md#force-limit.
class ForceLimit {
public:
    /// \param cycle time between two wrenches [s], > 0
    /// Errors: invalid_argument (a limit is negative or not finite, or all are 0; cycle).
    static Result<ForceLimit> create(const WrenchLimits& limits, Seconds cycle);

    /// Takes the wrench of this cycle.
    /// \return the first limit found that it exceeds; nothing if there is none
    std::optional<ForceExcess> check(const Wrench& measured) noexcept;

    /// Wrench after the low-pass.
    const Wrench& filtered() const noexcept { return filtered_; }

private:
    ForceLimit(const WrenchLimits& limits, double gain) noexcept : limits_(limits), gain_(gain) {}

    WrenchLimits limits_;
    double gain_;
    bool started_ = false;
    Wrench filtered_;
};

}  // namespace metier::motion
