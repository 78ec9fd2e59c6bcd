#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "commands.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::app {

/// Folder share/metier/NAME of the installed program; of one that is not installed the other.
std::filesystem::path sharedFolder(const char* name, const char* otherwise);

/// Adds the argument ROBOT to a command: a model's name or its file.
void addRobot(CLI::App& command, std::string& robot);

/// The model of that name (`ur5`), or of that file if it has a slash or ends in .toml. Names are
/// looked up in share/metier/models beside the program's bin, then in the source tree's models.
/// Errors: invalid_argument, with the names there are, or as RobotModel::load().
Result<motion::RobotModel> loadRobot(const std::string& robot);
/// All models there, by name. Errors: as RobotModel::load().
Result<std::vector<motion::RobotModel>> loadAllRobots();

/// The names of the models there are, in the order of the alphabet.
std::vector<std::string> robotNames();
/// Whether it has one of these names, or is written as the file of a model.
bool isRobot(const std::string& robot);

}  // namespace metier::app
