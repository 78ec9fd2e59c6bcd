#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::virtual_edo {

/// Differences of one release of the robot's software from the others on the wire.
///
/// Source: Comau/eDO_core and Comau/eDO_core_msgs, the releases of 2019-04 to 2022-06.
struct Software {
    std::string version;  ///< such as "3.2.0"
    /// From 3.1.2 on: set-points come by /external_control, mode 0 gives control back, the node
    /// goes on publishing while it is switched off, MovementCommand has a payload, commandFlag 16
    /// bits, and there are services for the tool and for the count of calibrations.
    bool external_control = false;
    /// From 3.0.1 on: JointState has R_jnt, JointControl has R_rasp.
    bool residuals = false;

    /// Errors: not_found, with the releases there are.
    static Result<Software> find(std::string_view version);
};

}  // namespace metier::virtual_edo
