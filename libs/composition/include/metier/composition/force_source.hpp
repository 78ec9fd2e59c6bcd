#pragma once

#include <optional>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/skill/value.hpp"

namespace metier::composition {

/// A force as some server publishes it.
struct MeasuredForce {
    /// Force in the axes of the sensor [N].
    skill::Vector3 force{};
    /// Torque in the same axes [N m]; none: it is not measured.
    std::optional<skill::Vector3> torque{};
    /// Frame of the sensor in the base frame of the arm [m, rad]; only its orientation is used.
    skill::Frame pose{};
    /// Time at which the force arrived here.
    SteadyTime received{};
};

/// Listener to a ForceSource. Threading: the owner's thread.
class ForceListener {
public:
    virtual ~ForceListener() = default;
    /// Reports a new force.
    virtual void onForce(const MeasuredForce& measured) = 0;
    /// Reports that no force is known from now on; onForce() comes again once one is.
    virtual void onForceLost(const Error& why) = 0;
};

/// A force that is measured anywhere. Threading: the owner's thread; nothing waits.
class ForceSource {
public:
    virtual ~ForceSource() = default;
    /// Name for messages: "FlangeForce of press".
    virtual const std::string& name() const = 0;
    /// The last force.
    /// Errors: connection_lost, device_fault: none is known now, with the reason.
    virtual Result<MeasuredForce> newest() const = 0;
    /// Adds a listener, which must be removed before it ends.
    virtual void add(ForceListener& listener) = 0;
    /// Removes a listener; allowed inside a listener's function. Nothing happens if it is not
    /// there.
    virtual void remove(ForceListener& listener) = 0;
};

}  // namespace metier::composition
