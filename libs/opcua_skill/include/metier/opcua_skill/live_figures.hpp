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

// What changes all the time, as Variables of namespace `urn:metier:skills` that any client may read
// or subscribe to. Each function is called on the server's thread whenever a client reads or is to
// be told, and must return at once; what it has nothing for is BadNoCommunication.
// Threads: those of AddressSpace. Errors: those of AddressSpace::addVariable().

/// What acts on a flange, in the axes of its sensor.
struct FlangeWrench {
    std::array<double, 3> force{};   ///< [N]
    std::array<double, 3> torque{};  ///< [N m]
};

/// How well the set-points of a position stream come, of the one that runs or else of the last.
struct StreamFigures {
    double lag = 0.0;           ///< how much longer than PlayOutDelay the newest one waits [s]
    double largest_lag = 0.0;   ///< since the stream's start [s]
    double clock_step = 0.0;    ///< largest step of the client's clock; below 0: back [s]
    std::uint64_t refused = 0;  ///< when they were written
    std::uint64_t dropped = 0;  ///< for a time that was not after that of the one before
};

/// How soon an arm would stand if it were halted now.
struct StoppingFigures {
    double time = 0.0;      ///< [s]
    double distance = 0.0;  ///< of its tool frame [m]
};

/// An arm besides its KinematicsState. An empty function: the arm does not have it, and there is no
/// Variable.
struct ArmFigures {
    /// CommandedJointPosition: the last set-point that the controller took [rad].
    std::function<std::optional<std::vector<double>>()> commanded_joint_position{};
    /// Standstill: whether the measured arm stands.
    std::function<std::optional<bool>()> standstill{};
    /// StoppingTime, StoppingDistance.
    std::function<std::optional<StoppingFigures>()> stopping{};
    /// CycleJitter: how far cycles were off their period lately, in the mean [s].
    std::function<std::optional<double>()> cycle_jitter{};
    /// FlangeForce, FlangeTorque.
    std::function<std::optional<FlangeWrench>()> flange_wrench{};
    /// StreamLag, LargestStreamLag, StreamClockStep, RefusedSetPoints, DroppedSetPoints.
    std::function<StreamFigures()> stream{};
};

/// \param kinematics of the arm's motion device
Result<void> publishArmFigures(opcua::AddressSpace& nodes, const opcua::NodeId& kinematics,
                               const ArmFigures& figures);

/// A gripper now.
struct GripperFigures {
    double width = 0.0;  ///< between the jaws [m]
    double force = 0.0;  ///< on the part [N]
    bool part_held = false;
};

struct GripperKind {
    double stroke = 0.0;  ///< largest width [m]
    bool measures_force = false;
};

/// Adds GripperStroke, GripperWidth, GripperForce if it measures it, and PartHeld: whether the
/// gripper holds a part, between the executions of its skills, too.
/// \param parent the object that the gripper's skills belong to
Result<void> publishGripperFigures(opcua::AddressSpace& nodes, const opcua::NodeId& parent,
                                   const GripperKind& kind,
                                   std::function<std::optional<GripperFigures>()> figures);

}  // namespace metier::opcua_skill
