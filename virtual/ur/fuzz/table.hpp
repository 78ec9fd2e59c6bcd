#pragma once

#include "../tests/robot_fixture.hpp"

namespace metier::virtual_ur {

/// A robot that is made once: reading its model takes longer than an input.
inline RobotOnTable& table() {
    static RobotOnTable robot("ur5", {{"unlock_delay", 0.0}, {"power_on_time", 0.0}});
    return robot;
}

}  // namespace metier::virtual_ur
