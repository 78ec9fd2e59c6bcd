#pragma once

#include "metier/composition/synchronized_move_skill.hpp"
#include "metier/skill/field_list.hpp"

namespace metier::composition {

/// \param arms the names of all of them, which are the default
skill::FieldList<Parameters> parameterFields(std::vector<std::string> arms);
const skill::FieldList<Results>& resultFields();

}  // namespace metier::composition
