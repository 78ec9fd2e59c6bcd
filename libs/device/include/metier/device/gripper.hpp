#pragma once

#include <functional>
#include <optional>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/device/arm.hpp"

namespace metier::device {

/// What does not change while the gripper is connected.
struct GripperInfo {
    std::string name;
    double stroke = 0.0;     ///< largest distance between the jaws [m]
    double min_force = 0.0;  ///< [N]
    double max_force = 0.0;  ///< [N]; 0: the gripper has no force control
    double max_speed = 0.0;  ///< of the distance between the jaws [m/s]
};

/// The gripper as it reports itself. Trivially copyable.
struct GripperState {
    double width = 0.0;  ///< between the jaws [m]
    double force = 0.0;  ///< on the part [N]; 0 if it is not measured
    bool moving = false;
    bool part_held = false;
    SafetyState safety = SafetyState::disconnected;
    SteadyTime stamp{};  ///< when this state was taken
};

/// What a motion of the jaws is asked to do; empty means the gripper's own.
struct GripperRequest {
    std::optional<double> width{};  ///< of the part or the opening [m]
    std::optional<double> force{};  ///< [N]
    std::optional<double> speed{};  ///< [m/s]
};

/// How a motion of the jaws ended.
struct GripperOutcome {
    double width = 0.0;  ///< [m]
    bool part_held = false;
};

/// A gripper with jaws: what every driver of one offers.
///
/// One motion at a time. `done` is called exactly once for each that was accepted, on the gripper's
/// notifying thread; it may lock, should not wait. Its errors: device_fault (no part found,
/// blocked, lost; the text says which), cancelled after stop(), connection_lost, timeout.
///
/// Threading: every function from any thread; none waits for the gripper.
class Gripper {
public:
    using Done = std::function<void(Result<GripperOutcome>)>;
    using SafetyCallback = std::function<void(const Safety&)>;

    virtual ~Gripper() = default;

    virtual const GripperInfo& info() const noexcept = 0;
    /// The newest state; neither locks nor allocates.
    virtual GripperState state() const noexcept = 0;
    virtual Safety safety() const = 0;

    /// Closes until it holds a part. Done with device_fault if there is none.
    /// Errors of all three: resource_unavailable while a motion runs, out_of_range,
    ///                      device_fault if the safety state is not normal, connection_lost.
    virtual Result<void> grasp(const GripperRequest& request, Done done) = 0;
    /// Opens and lets the part go.
    virtual Result<void> release(const GripperRequest& request, Done done) = 0;
    /// Moves the jaws to request.width, whether or not there is a part.
    virtual Result<void> move(const GripperRequest& request, Done done) = 0;
    /// Stops the motion; the jaws keep holding. Nothing happens if none runs.
    virtual void stop() noexcept = 0;

    /// Asks the gripper to leave a fault. Does not wait for it: it is called on the thread of a
    /// server. Errors: timeout: the reset has begun or goes on, ask again for its outcome;
    /// device_fault, connection_lost.
    virtual Result<void> resetFault() = 0;
    /// Calls `callback` on the notifying thread after each change of the safety state.
    /// A part that is lost is such a change for nobody: see state().
    virtual Registration onSafetyChange(SafetyCallback callback) = 0;
};

}  // namespace metier::device
