#pragma once

#include <string>

#include "metier/motion/robot_model.hpp"
#include "primary_session.hpp"

namespace metier::ur_driver {

/// The arm as its controller describes it: its own calibrated kinematics, and of every limit the
/// stricter one of the file's and the controller's, with the margin that the maker's own presets
/// keep (docs/protocols/ur.md#limits).
/// \param file of a UR arm with six axes
/// Errors: invalid_argument if the controller has another arm than the file, or tells nonsense.
Result<motion::RobotModel> describedModel(const motion::RobotModel& file,
                                          const ControllerDescription& description);

/// How the controller's arm differs from the model that is used, for a person; empty if it does
/// not.
std::string differenceText(const motion::RobotModel& used,
                           const ControllerDescription& description);

}  // namespace metier::ur_driver
