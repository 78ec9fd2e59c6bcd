#pragma once

#include <optional>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/path_evaluation/motion_curves.hpp"
#include "metier/path_evaluation/motion_record.hpp"
#include "recorded.hpp"

namespace metier::app {

/// Content of a picture of a motion.
struct DrawnMotion {
    std::vector<path_evaluation::MotionSample> samples;
    std::vector<Eigen::Vector3d> tool_positions;  ///< [m, base frame]
    std::string note;
    std::optional<double> asked_speed;  ///< wanted speed of the tool frame [m/s]
};

/// Name of the robot, for a picture's title.
std::string titleOf(const motion::RobotModel& model);
/// \param name of the record, for messages and the note
/// \param tool of the model; empty: the flange
/// Errors: invalid_argument (other number of axes, no such tool).
Result<DrawnMotion> recordedMotion(const motion::RobotModel& model,
                                   const path_evaluation::MotionRecord& record,
                                   const std::string& name, const std::string& tool);
/// Draws into the file; "-": standard output.
/// \param title empty: the robot's name
Result<Exit> drawInto(const std::string& file, const motion::RobotModel& model,
                      const std::string& title, const DrawnMotion& motion);

/// Options for the drawing of a recorded execution.
struct ExecutionDrawing {
    std::string records;  ///< URL
    std::string id;       ///< number or id
    std::string robot;    ///< empty: that of the record
    std::string tool;
    std::string title;
    std::string svg;
};
Result<Exit> drawExecution(const ExecutionDrawing& drawing);

}  // namespace metier::app
