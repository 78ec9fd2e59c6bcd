#pragma once

#include <string>
#include <vector>

#include "finding/arm_figures.hpp"
#include "metier/base/error.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/composition/definition.hpp"

namespace metier::server {

/// A skill that some server offers.
struct OfferedSkill {
    std::string server;     ///< its name in the cell file, or its address
    std::size_t index = 0;  ///< index of the server
    client::SkillAddress address;
    ArmFigures arm{};  ///< figures of the arm that it moves
};

/// Whether a skill is of that type: by the BrowseName of its type, or, for composed skills, which
/// all are of SequenceSkillType, by its own name with "Type".
bool isOfType(const client::SkillAddress& skill, const std::string& type);

/// Errors: invalid_argument, if a use that a skill of the same server serves asks for more than
/// that.
Result<void> checkOwn(const composition::Use& use);

/// The one skill that a file asks for.
/// Errors: not_found, with what there is; invalid_argument, with the names of all that fit.
Result<OfferedSkill> choose(const composition::Use& use, const std::vector<OfferedSkill>& offered);

}  // namespace metier::server
