#pragma once

#include <utility>

#include "metier/skill/field_list.hpp"

namespace metier::robot_skills {

/// FieldList::add() for a member that Parameters inherits.
template <typename Parameters, typename Base, typename Member>
void add(skill::FieldList<Parameters>& fields, Member Base::*member, skill::Field field) {
    Member Parameters::*own = member;
    fields.add(own, std::move(field));
}

}  // namespace metier::robot_skills
