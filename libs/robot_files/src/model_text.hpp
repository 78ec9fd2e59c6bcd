#pragma once

#include <string>
#include <vector>

#include "metier/motion/robot_model.hpp"

namespace metier::robot_files {

/// The text of a model file (models/README.md): RobotModel::parse() reads the same numbers.
/// \param comments lines without '#' for the head of the file; control characters become '?'
std::string modelText(const motion::RobotAppearance& appearance,
                      const motion::ChainDescription& chain,
                      const std::vector<std::string>& comments);

}  // namespace metier::robot_files
