#pragma once

#include <map>
#include <string>

#include "metier/base/error.hpp"
#include "metier/composition/definition.hpp"
#include "metier/skill/skill.hpp"

namespace metier::composition {

/// Descriptions of the used skills by alias.
using Descriptions = std::map<std::string, skill::SkillDescription, std::less<>>;

/// A definition whose bindings fit the skills that it uses.
struct Composition {
    /// Steps and bindings; their Literals have the types of their targets.
    Definition definition;
    /// Description of the composed skill.
    skill::SkillDescription description;
    /// The definition as it was given, with what is optional and was left out: other skills may
    /// have it.
    Definition given{};
};

/// Checks names, types, units, ranges and lengths of all bindings against the used skills. What is
/// optional and not there is left out: steps, arguments, sources of results.
/// \param used description of each used skill by its alias
/// Errors: invalid_argument, with one line "file:line: key: why" for each mistake. Threads: any;
///         pure.
Result<Composition> compose(Definition definition, const Descriptions& used);

/// Description of the composed skill for its clients.
skill::SkillDescription descriptionOf(const Definition& definition);

}  // namespace metier::composition
