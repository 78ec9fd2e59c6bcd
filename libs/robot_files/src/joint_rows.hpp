#pragma once

#include <optional>
#include <string>
#include <vector>

#include "chain_choice.hpp"
#include "metier/motion/chain.hpp"
#include "metier/robot_files/import.hpp"

namespace metier::robot_files {

/// How the angles of a file are taken.
enum class Angles { as_written, rounded };

/// The axes of a chain with their limits. Notes errors in the file, such as limits that neither the
/// file nor the options give.
/// \param assumed gets a line for each kind of value that nobody gave
std::vector<motion::JointDescription> readAxes(const ChosenChain& chain,
                                               const ImportOptions& options,
                                               std::vector<std::string>& assumed);

/// Places of the axes and of the flange.
struct ChainFrames {
    std::vector<motion::Pose> parent_from_joint;
    std::vector<Eigen::Vector3d> axis;
    motion::Pose last_from_flange;
};
/// Notes errors in the file.
ChainFrames readFrames(const ChosenChain& chain, Angles angles);

}  // namespace metier::robot_files
