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

/// Whether a skill is of that very type: by the BrowseName of its type, or by its own name with
/// "Type", as a composed skill of SequenceSkillType is named.
bool isOfType(const client::SkillAddress& skill, const std::string& type);

/// Errors: invalid_argument, if a use that a skill of the same server serves asks for more than
/// that.
Result<void> checkOwn(const composition::Use& use);

/// Whether a skill of a derived type may serve a use that nothing of the very type serves.
enum class Derived { taken, left_out };

/// The one skill that a file asks for: one of the very type, isOfType(), or else one that may stand
/// in for it.
/// Errors: not_found, with what there is; invalid_argument, with the names of all that fit.
Result<OfferedSkill> choose(const composition::Use& use, const std::vector<OfferedSkill>& offered,
                            Derived derived = Derived::taken);

}  // namespace metier::server
