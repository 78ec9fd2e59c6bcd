#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "chain_choice.hpp"
#include "joint_rows.hpp"
#include "metier/motion/robot_model.hpp"
#include "semantics.hpp"

namespace metier::robot_files {

/// A link that is held by the base or by a link that an axis moves.
struct HeldLink {
    std::size_t link = 0;
    motion::Pose frame_from_link;
};

/// The links of a file that are one link of a model.
using LinkGroup = std::vector<HeldLink>;
/// Element 0 holds those of the base, element i those that axis i moves.
using LinkGroups = std::vector<LinkGroup>;

/// Notes errors in the file.
LinkGroups groupLinks(const ChosenChain& chain, Angles angles);

/// Capsules from collision elements, and shapes to draw from visual elements. A sphere, a cylinder
/// or a box becomes the capsule around it. Notes errors in the file.
/// \param left_out gets a line for what has no place in a model, such as meshes
void readShapes(const ChosenChain& chain, const LinkGroups& groups,
                motion::RobotAppearance& appearance, std::vector<std::string>& left_out);

/// Tool frames: the links that fixed joints hold to the tip.
/// \param left_out gets a line for each link whose name no tool can have
std::vector<motion::ToolFrame> readTools(const ChosenChain& chain, Angles angles,
                                         std::vector<std::string>& left_out);

/// Pairs of links of the model that would be compared, and whose links in the file are all disabled
/// pairs of the SRDF file. A pair of which only some are disabled goes on being compared.
/// \param remarks gets a line about such pairs
std::vector<motion::UncomparedLinks> readUncompared(const RobotTree& tree, const LinkGroups& groups,
                                                    const Semantics& semantics,
                                                    std::vector<std::string>& remarks);

/// Lines about joints beside the chain, which are left out with everything behind them.
std::vector<std::string> jointsBeside(const ChosenChain& chain, const LinkGroups& groups);

}  // namespace metier::robot_files
