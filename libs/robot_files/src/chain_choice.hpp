#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robot_tree.hpp"

namespace metier::robot_files {

/// The part of a tree that becomes a robot model.
struct ChainChoice {
    std::size_t base = 0;
    std::size_t tip = 0;
    /// Joints from the base to the tip, fixed ones included.
    std::vector<std::size_t> joints;
    /// Joints of `joints` that are axes.
    std::vector<std::size_t> axes;
    /// How the tip was found; empty if it was given.
    std::string why_this_tip;
};

/// Links by their names; empty: not given.
struct ChainEnds {
    std::string base;
    std::string tip;
};

/// Chooses the chain from the base, else the only root, to the tip. Without a tip: the only chain
/// whose joints can all be axes, up to its link "tool0", else "flange", else the only last link,
/// else the last link that an axis moves. Notes errors in the file, each with the joint that stands
/// in the way and a choice that avoids it.
/// \param tree without errors so far
/// \return nothing if an error was noted
std::optional<ChainChoice> chooseChain(XmlFile& file, const RobotTree& tree, const ChainEnds& ends);

/// A chosen chain, the file that it is in, and the file's tree. Refers to all three.
struct ChosenChain {
    XmlFile& file;
    const RobotTree& tree;
    const ChainChoice& choice;
};

}  // namespace metier::robot_files
