#pragma once

#include <string>
#include <vector>

#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"

namespace metier::client {

/// An axis of a motion device (OPC 40010-1).
struct RoboticsAxis {
    std::string name;               ///< BrowseName
    opcua::NodeId position;         ///< ParameterSet/ActualPosition, Double
    double radians_per_unit = 1.0;  ///< by its EngineeringUnits
};

/// A motion device of another maker, as OPC 40010-1 has it.
struct RoboticsArm {
    std::string name;                ///< BrowseName of the motion device
    std::vector<RoboticsAxis> axes;  ///< as the server lists them
    /// Booleans of the safety states of its system; empty: it publishes none.
    std::vector<opcua::NodeId> emergency_stops{};
    std::vector<opcua::NodeId> protective_stops{};
};

/// Finds the motion device that a skill moves: the one that the skill is part of, else the only
/// one, or the only one of that name, with axes in the nearest object above the skill that has a
/// folder MotionDevices, else the only one of the systems in DeviceSet. Errors: not_found;
/// invalid_argument for several that it could be, and for an axis whose unit is
///         neither rad nor degree; those of the server. Threads: any but the client's own; waits.
/// \param device BrowseName; empty: any
opcua::Answer<RoboticsArm> findRoboticsArm(opcua::Client& client, const SkillAddress& skill,
                                           const std::string& device);

/// Reads how many radians one unit of a Variable is, by its EngineeringUnits.
/// \param preset for a Variable without that Property; 0: it is an error then
/// Errors: invalid_argument, with the name, for any other unit; those of the server.
/// Threads: as above.
opcua::Answer<double> radiansPerUnit(opcua::Client& client, const opcua::NodeId& variable,
                                     const std::string& name, double preset);

}  // namespace metier::client
