#pragma once

#include <optional>
#include <string>
#include <vector>

#include "metier/client/kinematics_reader.hpp"
#include "metier/client/lack.hpp"
#include "metier/client/remote_arm.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"
#include "remote_arm/axis_order.hpp"
#include "remote_arm/robotics_arm.hpp"

namespace metier::client {

/// Arm that a position stream moves, as its server publishes it.
struct PublishedArm {
    std::string name;                        ///< BrowseName of the motion device
    opcua_skill::KinematicsData kinematics;  ///< published, or given
    std::vector<std::string> axis_names;     ///< axis 1 first
    /// Nodes of Kinematics, of a server of metier; none: `robotics` has the arm's state.
    std::optional<KinematicsNodes> nodes{};
    RoboticsArm robotics{};
    /// Place of each joint in `robotics` and in the server's arrays; empty: all in order.
    std::vector<JointPlace> places{};

    /// Lists what a motion of it cannot have.
    std::vector<Lack> lacks() const;
};

/// Finds the arm that a skill moves: by its Kinematics, or else by OPC 40010-1, with the given
/// kinematics.
/// Errors: not_found, if it publishes neither, or no Kinematics and none are given; not_supported
///         for more axes than there can be; those of placesOf() and of the server.
/// Threads: any but the client's own; waits.
Result<PublishedArm> findArm(opcua::Client& client, const SkillAddress& skill,
                             const std::optional<GivenArm>& given);

/// Difference of the arm that is published now from the former one, for a person; empty: none.
std::string changeOf(const PublishedArm& now, const PublishedArm& former, const std::string& url);

}  // namespace metier::client
