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
    /// Name of the server that has the gripper, for messages.
    std::string name;
    /// Largest opening of the jaws [m].
    double stroke = 0.0;
    /// Least force that the gripper can be asked for [N].
    double min_force = 0.0;
    /// Largest force that the gripper can be asked for [N]; 0: the gripper has no force control.
    double max_force = 0.0;
    /// Largest change of the distance between the jaws [m/s].
    double max_speed = 0.0;
};

/// The gripper as it reports itself. Trivially copyable.
struct GripperState {
    /// Distance between the jaws [m], 0: closed.
    double width = 0.0;
    /// Force on the part [N]; 0 if it is not measured.
    double force = 0.0;
    /// Whether the jaws move now.
    bool moving = false;
    /// Whether the gripper holds a part now, also between two motions.
    bool part_held = false;
    /// Safety state when this was published; its reason is at Gripper::safety().
    SafetyState safety = SafetyState::disconnected;
    /// Time at which this state was taken, on this machine's monotonic clock.
    SteadyTime stamp{};
};

/// Parameters of a motion of the jaws; an empty one takes the gripper's own value, which its
/// settings state.
struct GripperRequest {
    /// Width of the part or of the opening [m], 0 to GripperInfo::stroke; a move needs it.
    std::optional<double> width{};
    /// Force on the part [N], GripperInfo::min_force to max_force; not_supported without force
    /// control.
    std::optional<double> force{};
    /// Change of the distance between the jaws [m/s], over 0, up to GripperInfo::max_speed.
    std::optional<double> speed{};
};

/// Result of a motion of the jaws.
struct GripperOutcome {
    /// Distance between the jaws at the end [m].
    double width = 0.0;
    /// Whether the gripper holds a part at the end.
    bool part_held = false;
};

/// A gripper with jaws: the interface of every gripper driver:
///
///     auto asked = gripper.grasp({.force = 20.0}, [](Result<GripperOutcome> outcome) { ... });
///
/// It makes one motion at a time. `done` is called exactly once for each accepted motion, on the
/// gripper's notifying thread; it may lock but should not wait. Errors of `done`: device_fault (no
/// part found, jaws blocked, part lost; the text says which), cancelled after stop(),
/// connection_lost, timeout.
///
/// Threading: every function from any thread; none waits for the gripper.
class Gripper {
public:
    /// Callback for the end of a motion; the motion is over when it is called, so it may begin the
    /// next.
    using Done = std::function<void(Result<GripperOutcome>)>;
    /// Callback for a change of the safety state; may lock, should not wait.
    using SafetyCallback = std::function<void(const Safety&)>;

    virtual ~Gripper() = default;

    /// Properties of the gripper; they do not change while this object lives.
    virtual const GripperInfo& info() const noexcept = 0;
    /// The newest state; neither locks nor allocates.
    virtual GripperState state() const noexcept = 0;
    /// Newest safety state with its reason.
    virtual Safety safety() const = 0;

    /// Closes the jaws until they hold a part. `done` gets device_fault if there is none.
    /// Errors of all three: resource_unavailable while a motion runs, out_of_range (with value and
    /// limits), invalid_argument (a move without a width), not_supported (a force for a gripper
    /// without force control), device_fault if the safety state is not normal, connection_lost.
    /// `done` is not called then.
    virtual Result<void> grasp(const GripperRequest& request, Done done) = 0;
    /// Opens the jaws to request.width, or as far as the gripper's own setting says, and lets the
    /// part go.
    virtual Result<void> release(const GripperRequest& request, Done done) = 0;
    /// Moves the jaws to request.width, which is needed, whether or not there is a part.
    virtual Result<void> move(const GripperRequest& request, Done done) = 0;
    /// Stops the motion; the jaws keep holding, and `done` gets cancelled. Does nothing if no
    /// motion runs.
    virtual void stop() noexcept = 0;

    /// Asks the gripper to leave a fault; returns success if its safety state is normal. Does not
    /// wait for it, since a server's thread calls it.
    /// Errors: timeout: the reset has begun or goes on, call again for its outcome; device_fault,
    ///         connection_lost.
    virtual Result<void> resetFault() = 0;
    /// Calls `callback` on the notifying thread after each change of the safety state. A lost part
    /// is not such a change: see state().
    virtual Registration onSafetyChange(SafetyCallback callback) = 0;
};

}  // namespace metier::device
