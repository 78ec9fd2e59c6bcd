#pragma once

#include "metier/skill/field_list.hpp"
#include "metier/synchronized_move/synchronized_move_skill.hpp"

namespace metier::synchronized_move {

/// \param arms the names of all of them, which are the default
skill::FieldList<Parameters> parameterFields(std::vector<std::string> arms);
const skill::FieldList<Results>& resultFields();

}  // namespace metier::synchronized_move
