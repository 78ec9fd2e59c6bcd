#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "metier/base/error.hpp"
#include "metier/motion/trajectory.hpp"
#include "metier/motion/wrench.hpp"

namespace metier::motion {

/// Largest force and torque with which an arm may press, each 0 or more; 0: no limit, and at least
/// one must be over 0.
struct WrenchLimits {
    /// Largest length of the force [N].
    double force = 0;
    /// Largest length of the torque [N m].
    double torque = 0;
    /// Largest |force| along x, y, z [N], then |torque| about x, y, z [N m], in the frame of the
    /// wrench.
    std::array<double, 6> components{};
};

/// A limit that the filtered wrench exceeds.
struct ForceExcess {
    /// Quantity that is over its limit.
    enum class Quantity {
        force,      ///< length of the force
        torque,     ///< length of the torque
        component,  ///< force or torque along or about one axis
        not_finite  ///< a component that the sensor did not measure
    };
    /// The first quantity found, in the order above.
    Quantity quantity = Quantity::force;
    /// Index of the component, 0 to 5 as in WrenchLimits; for component and not_finite.
    std::size_t component = 0;
    /// Filtered value [N] or [N m], with its sign for a component; for not_finite as measured.
    double value = 0;
    /// Its limit, same unit; 0 for not_finite.
    double limit = 0;
};
/// Error text for a person, with quantity, value, limit and unit. Allocates. The code is
/// device_fault for not_finite, else out_of_range.
Error toError(const ForceExcess& excess);

/// Watches the wrench of a force-limited motion. The caller acts on an excess: it calls
/// MotionRun::halt() in the same cycle:
///
///     if (auto excess = limit.check(wrench)) { run.halt(); }  // once per cycle
///
/// The wrench passes a first-order low-pass of 20 Hz that starts at the first value: a steady
/// wrench below a limit is never an excess, one above it becomes an excess within a few cycles. A
/// value that is not finite is an excess at once, so that a failed sensor is not taken for a small
/// force.
/// Threading: one thread, the control cycle. Checking does not allocate, lock or throw.
/// Source: docs/motion.md#force-limit.
class ForceLimit {
public:
    /// \param limits in the frame of the wrenches that check() gets
    /// \param cycle  time between two wrenches [s], > 0
    /// Errors: invalid_argument (a limit is negative or not finite, or all are 0; cycle).
    static Result<ForceLimit> create(const WrenchLimits& limits, Seconds cycle);

    /// Takes the wrench of this cycle; call it once per cycle. A wrench that is not finite does not
    /// enter the low-pass.
    /// \return the first limit found that it exceeds; nothing if there is none
    std::optional<ForceExcess> check(const Wrench& measured) noexcept;

    /// Wrench after the low-pass; zero before the first check().
    const Wrench& filtered() const noexcept { return filtered_; }

private:
    ForceLimit(const WrenchLimits& limits, double gain) noexcept : limits_(limits), gain_(gain) {}

    WrenchLimits limits_;
    double gain_;
    bool started_ = false;
    Wrench filtered_;
};

}  // namespace metier::motion
