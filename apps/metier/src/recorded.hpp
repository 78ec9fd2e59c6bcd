#pragma once

#include <string>

#include "commands.hpp"
#include "metier/base/error.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/path_evaluation/motion_record.hpp"
#include "metier/records/store.hpp"

namespace metier::app {

/// Store of this user's servers: `records.db` in the user's state folder.
std::string defaultRecords();
/// Refuses where records are with a password in it: everybody sees the command lines of a machine.
CLI::Validator withoutPassword();
/// Adds --records to a command.
/// \param help without the forms that it takes
void addRecords(CLI::App& command, std::string& url,
                const std::string& help = "Where the records are");

/// The model of the robot that an execution moved: the product that its device is, or the model
/// with the longest name that is in those of its device and server.
/// \param named by the user, instead; may be empty
/// Errors: invalid_argument, as loadRobot(), or if no model is named so.
Result<motion::RobotModel> robotOf(const records::ExecutionRow& execution,
                                   const std::string& named);

/// Recorded joint positions, for the drawings.
/// Errors: not_found (nothing was recorded), invalid_argument (too little, or other axes).
Result<path_evaluation::MotionRecord> pathOf(records::Store& store,
                                             const records::ExecutionRow& execution);

}  // namespace metier::app
