#pragma once

#include <string>

#include "metier/motion/robot_model.hpp"
#include "primary_session.hpp"

namespace metier::ur_driver {

/// Model of the arm by its controller's description: with its calibrated kinematics, and for each
/// limit the stricter one of the file and the controller, with the margin that the maker's own
/// presets keep (docs/protocols/ur.md#limits).
/// \param file model of a UR arm with six axes
/// Errors: invalid_argument if the controller has another arm than the file, or sends impossible
/// values.
Result<motion::RobotModel> describedModel(const motion::RobotModel& file,
                                          const ControllerDescription& description);

/// Differences of the controller's arm from the model in use, for a person; empty if there is none.
std::string differenceText(const motion::RobotModel& used,
                           const ControllerDescription& description);

}  // namespace metier::ur_driver
