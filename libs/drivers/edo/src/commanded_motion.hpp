#pragma once

#include <optional>
#include <string>

#include "options.hpp"

namespace metier::edo_driver {

/// A limit that a set-point broke; without text, so that a cycle thread can make it.
struct Violation {
    enum class Kind : std::uint8_t { axis_count, not_finite, position, step };

    Kind kind = Kind::axis_count;
    std::size_t axis = 0;  ///< from 0
    double value = 0.0;
    double limit = 0.0;
};

/// A sentence with axis (from 1), value, limit and unit.
std::string toText(const Violation& violation);

/// Commanded position of the axes: follows set-points, and brakes by itself, since an e.DO has no
/// stop of its own for joints that a client controls.
///
/// Threading: one thread, the cycle. Does not allocate.
class CommandedMotion {
public:
    /// \param axes must outlive this
    explicit CommandedMotion(const AxisOptions& axes);

    /// The axes stand here.
    void reset(const device::JointArray& position) noexcept;
    /// Calls reset(), unless the axes are there already within the noise of the measurement.
    void settle(const device::JointArray& measured) noexcept;

    /// Takes the next set-point, or leaves everything unchanged and says what it breaks.
    std::optional<Violation> accept(const device::JointArray& set_point) noexcept;
    /// Stays where it is.
    void hold() noexcept;
    /// Brakes each axis by one cycle.
    void brake() noexcept;

    const device::JointArray& position() const noexcept { return position_; }  ///< [rad]
    bool standing() const noexcept;

private:
    std::optional<Violation> check(std::size_t axis, double position) const noexcept;

    const AxisOptions& axes_;
    device::JointArray position_;
    device::JointArray velocity_;  // [rad/s]
};

/// Notices that the joints do not follow their set-points: dropped set-points leave no other trace.
///
/// Threading: one thread, the cycle. Does not allocate.
class FollowingWatch {
public:
    explicit FollowingWatch(const FollowingOptions& options) : options_(options) {}

    struct Lag {
        std::size_t axis = 0;
        double distance = 0.0;  ///< [rad]
    };

    void reset() noexcept { behind_since_.reset(); }
    /// \return the axis that is farthest behind once that lasted too long
    std::optional<Lag> check(const device::JointArray& commanded,
                             const device::JointArray& measured, SteadyTime now) noexcept;

private:
    FollowingOptions options_;
    std::optional<SteadyTime> behind_since_;
};

/// Decides when a set-point is due: one per cycle, although joint states may come in bunches.
///
/// Threading: one thread, the cycle.
class Pacer {
public:
    explicit Pacer(Duration cycle) : cycle_(cycle) {}

    /// Reports whether a set-point is due now; it then counts as sent. A joint state may come half
    /// a cycle early, but on average there are no more set-points than cycles.
    bool due(SteadyTime now) noexcept;

private:
    Duration cycle_;
    SteadyTime next_{};
};

}  // namespace metier::edo_driver
