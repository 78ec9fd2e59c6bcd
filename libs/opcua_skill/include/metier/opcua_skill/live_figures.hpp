#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/opcua/node_id.hpp"

namespace metier::opcua_skill {

// Live values as Variables of namespace `urn:metier:skills`, which any client may read or subscribe
// to. The server's thread calls a function whenever a client reads its value and at each sampling
// of a subscription; it must return at once. A function without a result gives BadNoCommunication.
// Threads: those of AddressSpace. Errors: those of AddressSpace::addVariable().

/// Wrench at the flange, in the axes of the sensor.
struct FlangeWrench {
    /// Force along x, y, z [N].
    std::array<double, 3> force{};
    /// Torque about x, y, z [N m].
    std::array<double, 3> torque{};
};

/// Timing of a position stream's set-points, of the stream that runs or else of the last one.
struct StreamFigures {
    /// Time by which the newest set-point waits longer than PlayOutDelay [s].
    double lag = 0.0;
    /// Largest lag since the stream's start [s].
    double largest_lag = 0.0;
    /// Largest step of the client's clock [s]; negative: back.
    double clock_step = 0.0;
    /// Number of set-points that were refused when they were written.
    std::uint64_t refused = 0;
    /// Number of set-points that were dropped, since their time was not after that of the one
    /// before.
    std::uint64_t dropped = 0;
};

/// Stop of an arm, if it were halted now.
struct StoppingFigures {
    /// Time until it stands [s].
    double time = 0.0;
    /// Way of its tool frame [m].
    double distance = 0.0;
};

/// Live values of an arm besides its KinematicsState. An empty function: the arm does not have the
/// value, and no Variable is added.
struct ArmFigures {
    /// CommandedJointPosition: the last set-point that the controller took [rad].
    std::function<std::optional<std::vector<double>>()> commanded_joint_position{};
    /// Standstill: whether the measured arm does not move.
    std::function<std::optional<bool>()> standstill{};
    /// StoppingTime, StoppingDistance.
    std::function<std::optional<StoppingFigures>()> stopping{};
    /// CycleJitter: mean deviation of the latest cycles from their period [s].
    std::function<std::optional<double>()> cycle_jitter{};
    /// FlangeForce, FlangeTorque.
    std::function<std::optional<FlangeWrench>()> flange_wrench{};
    /// StreamLag, LargestStreamLag, StreamClockStep, RefusedSetPoints, DroppedSetPoints.
    std::function<StreamFigures()> stream{};
};

/// Adds the Variables of an arm's live values. The functions must stay valid until the server has
/// stopped.
/// \param kinematics Kinematics object of the arm's motion device
Result<void> publishArmFigures(opcua::AddressSpace& nodes, const opcua::NodeId& kinematics,
                               const ArmFigures& figures);

/// Live values of a gripper.
struct GripperFigures {
    /// Distance between the jaws [m].
    double width = 0.0;
    /// Force on the part [N].
    double force = 0.0;
    /// Whether the jaws hold a part.
    bool part_held = false;
};

/// Properties of a gripper that do not change.
struct GripperKind {
    /// Largest width [m].
    double stroke = 0.0;
    /// Whether the gripper reports its force; false: no Variable GripperForce is added.
    bool measures_force = false;
};

/// Adds GripperStroke, GripperWidth, PartHeld and, if the gripper measures it, GripperForce.
/// PartHeld shows whether the gripper holds a part, also between the executions of its skills.
/// \param parent  the object that the gripper's skills belong to
/// \param figures must stay valid until the server has stopped; without a result: no connection
Result<void> publishGripperFigures(opcua::AddressSpace& nodes, const opcua::NodeId& parent,
                                   const GripperKind& kind,
                                   std::function<std::optional<GripperFigures>()> figures);

}  // namespace metier::opcua_skill
