#pragma once

#include <string>
#include <variant>
#include <vector>

#include "metier/skill/field.hpp"
#include "metier/skill/skill.hpp"

namespace metier::skill {

/// Unit of a frequency, for properties.
inline constexpr Unit kHertz{"Hz", "hertz", "HTZ"};

/// A fact that holds for all skills of a type, such as a control frequency or an accuracy.
struct TypeProperty {
    /// BrowseName, unique within the type.
    std::string name{};
    /// Value, a number in `unit`.
    std::variant<bool, double, std::string> value{};
    /// Unit of a number.
    Unit unit = kOne;
    /// One line for a person.
    std::string description{};
};

/// A type of skills: what all skills of the type have in common for a client.
struct SkillType {
    /// BrowseName, such as "SpotWeldSkillType". With `extends` the name of a type that is there.
    std::string name{};
    /// BrowseName of the type above it.
    std::string base = "SkillType";
    /// Whether the type is there already, in another namespace, and only gets properties and terms.
    bool extends = false;
    /// One line for a person.
    std::string description{};
    /// Parameters besides those of the base; those that are `optional` need not be there.
    Fields parameters{};
    /// Results besides those of the base.
    Fields results{};
    /// Tasks of the skills: terms of metier's dictionary, such as "grasp", or URIs.
    std::vector<std::string> terms{};
    /// Facts about all skills of the type.
    std::vector<TypeProperty> properties{};
};

/// Types of one namespace.
struct SkillTypes {
    /// URI of the namespace, which belongs to whoever declares the types.
    std::string uri{};
    /// Version of the model, such as "1.0.0".
    std::string version = "1.0.0";
    /// The types, in any order.
    std::vector<SkillType> types{};
};

/// The type of a skill with that description, for a type that is declared together with it:
///
///     auto type = skillTypeOf(WeldSkill().description());
///     type.terms = {"weld"};
///
/// Threads: any; pure.
inline SkillType skillTypeOf(const SkillDescription& description, std::string base = "SkillType") {
    SkillType type;
    type.name = description.type;
    type.base = std::move(base);
    type.description = description.description;
    type.parameters = description.parameters;
    type.results = description.results;
    return type;
}

}  // namespace metier::skill
