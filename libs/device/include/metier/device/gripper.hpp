#pragma once

#include <functional>
#include <optional>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/device/arm.hpp"

namespace metier::device {

/// Properties of a gripper that do not change while it is connected.
struct GripperInfo {
    std::string name;
    double stroke = 0.0;     ///< largest opening of the jaws [m]
    double min_force = 0.0;  ///< [N]
    double max_force = 0.0;  ///< [N]; 0: the gripper has no force control
    double max_speed = 0.0;  ///< largest change of the distance between the jaws [m/s]
};

/// The gripper as it reports itself. Trivially copyable.
struct GripperState {
    double width = 0.0;  ///< between the jaws [m]
    double force = 0.0;  ///< force on the part [N]; 0 if it is not measured
    bool moving = false;
    bool part_held = false;
    SafetyState safety = SafetyState::disconnected;
    SteadyTime stamp{};  ///< time at which this state was taken
};

/// Parameters of a motion of the jaws; an empty one takes the gripper's own value.
struct GripperRequest {
    std::optional<double> width{};  ///< width of the part or of the opening [m]
    std::optional<double> force{};  ///< [N]
    std::optional<double> speed{};  ///< [m/s]
};

/// Result of a motion of the jaws.
struct GripperOutcome {
    double width = 0.0;  ///< [m]
    bool part_held = false;
};

/// A gripper with jaws: the interface of every gripper driver.
///
/// It makes one motion at a time. `done` is called exactly once for each accepted motion, on the
/// gripper's notifying thread; it may lock but should not wait. Errors of `done`: device_fault (no
/// part found, jaws blocked, part lost; the text says which), cancelled after stop(),
/// connection_lost, timeout.
///
/// Threading: every function from any thread; none waits for the gripper.
class Gripper {
public:
    using Done = std::function<void(Result<GripperOutcome>)>;
    using SafetyCallback = std::function<void(const Safety&)>;

    virtual ~Gripper() = default;

    /// Properties of the gripper; they do not change while this object lives.
    virtual const GripperInfo& info() const noexcept = 0;
    /// The newest state; neither locks nor allocates.
    virtual GripperState state() const noexcept = 0;
    /// Newest safety state with its reason.
    virtual Safety safety() const = 0;

    /// Closes the jaws until they hold a part. `done` gets device_fault if there is none. Errors of
    /// all three: resource_unavailable while a motion runs, out_of_range,
    ///                      device_fault if the safety state is not normal, connection_lost.
    virtual Result<void> grasp(const GripperRequest& request, Done done) = 0;
    /// Opens the jaws and lets the part go.
    virtual Result<void> release(const GripperRequest& request, Done done) = 0;
    /// Moves the jaws to request.width, whether or not there is a part.
    virtual Result<void> move(const GripperRequest& request, Done done) = 0;
    /// Stops the motion; the jaws keep holding. Does nothing if no motion runs.
    virtual void stop() noexcept = 0;

    /// Asks the gripper to leave a fault. Does not wait for it, since a server's thread calls it.
    /// Errors: timeout: the reset has begun or goes on, call again for its outcome; device_fault,
    /// connection_lost.
    virtual Result<void> resetFault() = 0;
    /// Calls `callback` on the notifying thread after each change of the safety state. A lost part
    /// is not such a change: see state().
    virtual Registration onSafetyChange(SafetyCallback callback) = 0;
};

}  // namespace metier::device
