#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "messages.hpp"
#include "metier/base/clock.hpp"
#include "metier/device/gripper.hpp"

namespace metier::wsg50_driver {

/// State of the gripper by its updates so far.
///
/// Taking an update does not allocate. Threading: one thread.
class Observation {
public:
    /// Number of updates of each value at some time.
    using Mark = std::array<std::uint64_t, 4>;

    /// Takes a successful reply if it is an update of one of the four values.
    /// \return whether it was one
    /// Errors: invalid_argument, as the parsers.
    Result<bool> take(const Reply& reply, SteadyTime now);

    Mark mark() const noexcept { return counts_; }
    /// Reports whether every value was updated since.
    bool renewedSince(const Mark& mark) const noexcept;
    /// The value whose last update is older than `age`, or that came never; nothing if all are
    /// newer.
    std::optional<std::string_view> silentValue(SteadyTime now, SteadyTime::duration age) const;

    SystemState system() const noexcept { return system_; }
    GraspingState grasping() const noexcept { return grasping_; }
    double width() const noexcept { return width_; }  ///< [m]
    double force() const noexcept { return force_; }  ///< [N]
    bool partHeld() const noexcept { return grasping_ == GraspingState::holding; }
    /// State for readers of the gripper; the caller fills in its safety.
    device::GripperState state(SteadyTime now) const noexcept;

private:
    SystemState system_;
    GraspingState grasping_ = GraspingState::idle;
    double width_ = 0.0;
    double force_ = 0.0;
    Mark counts_{};
    std::array<SteadyTime, 4> stamps_{};
};

}  // namespace metier::wsg50_driver
