#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "metier/base/error.hpp"
#include "metier/motion/twist.hpp"
#include "metier/motion/trajectory.hpp"

namespace metier::motion {

/// What an arm may press with; 0: no limit.
struct WrenchLimits {
    double force = 0;   ///< length of the force [N]
    double torque = 0;  ///< length of the torque [Nm]
    /// Force along x, y, z [N], then torque about x, y, z [Nm], in the frame of the wrench.
    std::array<double, 6> components{};
};

/// A limit that the filtered wrench is beyond.
struct ForceExcess {
    enum class Quantity { force, torque, component, not_finite };
    Quantity quantity = Quantity::force;
    std::size_t component = 0;  ///< 0 to 5 as in WrenchLimits; for component and not_finite
    double value = 0;           ///< [N] or [Nm]
    double limit = 0;
};
/// For the person: what, value, limit, unit.
Error toError(const ForceExcess& excess);

/// Watches the wrench of a force-limited motion; what to do about an excess is up to the caller:
/// MotionRun::halt() in the same cycle.
///
/// The wrench passes a low-pass of first order with 20 Hz, which starts at the first value: a
/// steady wrench below a limit never is an excess, one above it is within a few cycles. A value
/// that is not finite is an excess at once: a sensor that fails must not blind the watch.
/// Threading: one thread, the control cycle. Checking does not allocate, lock or throw.
/// Source: docs/motion.md#force-limit.
class ForceLimit {
public:
    /// \param cycle between two wrenches [s], > 0
    /// Errors: invalid_argument (a limit is negative or not finite, or all are 0; cycle).
    static Result<ForceLimit> create(const WrenchLimits& limits, Seconds cycle);

    /// Takes the wrench of this cycle. \return the limit it is beyond, the first one found
    std::optional<ForceExcess> check(const motion::Wrench& measured) noexcept;

    /// After the low-pass.
    const motion::Wrench& filtered() const noexcept { return filtered_; }
    /// Forgets the past, as before the first check().
    void restart() noexcept { started_ = false; }

private:
    ForceLimit(const WrenchLimits& limits, double gain) noexcept : limits_(limits), gain_(gain) {}

    WrenchLimits limits_;
    double gain_;
    bool started_ = false;
    motion::Wrench filtered_;
};

}  // namespace metier::motion
