#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "command_context.hpp"
#include "metier/base/quantities.hpp"

namespace metier::app {

/// Parts in a row or on an arc around the robot, and the place of each.
struct PickPlaceSettings {
    Frame pick{0.3860, -0.1655, 0.0125, 3.14159265, 0, -0.405};   ///< pose of the first part
    Frame place{0.4209, -0.1805, 0.0125, 3.14159265, 0, -0.405};  ///< pose of the first part
    Vector3 step{0, 0, 0};                                        ///< from one part to the next [m]
    double turn = 0.09;  ///< from one part to the next, about z of the robot base [rad]
    int parts = 10;
    double approach = 0.05;  ///< [m]
    double force = 0.0;      ///< [N]; 0: the gripper's own
    std::chrono::seconds timeout{120};
    /// Number of further attempts after a failed part. Each begins with a Reset of everything that
    /// is Halted on its servers. Only for trials in which nobody can be in the way.
    int second_tries = 0;
    bool json = false;
};

/// Runs every PickPlaceSkill of the servers with its parts, all at the same time; shows the
/// progress and prints the result. After a failed part the skill is Reset, and takes the next part
/// or that one again.
/// Errors: a server that does not answer; no PickPlaceSkill.
Result<Exit> pickAndPlace(const CommandIdentity& identity, const std::vector<std::string>& urls,
                          const PickPlaceSettings& settings);

}  // namespace metier::app
