#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "command_context.hpp"
#include "metier/base/quantities.hpp"

namespace metier::app {

/// Parts in a row or on an arc about the robot, and where each goes.
struct PickPlaceSettings {
    Frame pick{0.3860, -0.1655, 0.0125, 3.14159265, 0, -0.405};   ///< of the first part
    Frame place{0.4209, -0.1805, 0.0125, 3.14159265, 0, -0.405};  ///< of the first part
    Vector3 step{0, 0, 0};                                        ///< from one part to the next [m]
    double turn = 0.09;  ///< from one part to the next, about z of the robot base [rad]
    int parts = 10;
    double approach = 0.05;  ///< [m]
    double force = 0.0;      ///< [N]; 0: the gripper's own
    std::chrono::seconds timeout{120};
    /// How often a part that failed is tried again, after a Reset of all that is Halted on its
    /// servers. Only for trials in which nobody can be in the way.
    int second_tries = 0;
    bool json = false;
};

/// Has every PickPlaceSkill that the servers have move its parts, all at the same time, shows how
/// it goes, and prints the result. After a part that failed the skill is Reset and takes the next,
/// or that part again.
Exit pickAndPlace(const CommandIdentity& identity, const std::vector<std::string>& urls,
                  const PickPlaceSettings& settings);

}  // namespace metier::app
