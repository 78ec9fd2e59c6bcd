#include "kinds/compositions.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "finding/skill_matching.hpp"
#include "host/skill_host.hpp"
#include "metier/base/random.hpp"
#include "metier/composition/composition.hpp"
#include "metier/composition/definition_file.hpp"
#include "metier/composition/local_used_skill.hpp"
#include "metier/composition/skill_type_file.hpp"
#include "metier/opcua_skill/skill_types.hpp"
#include "metier/opcua_skill/used_skills.hpp"

namespace metier::server {
namespace {

using composition::Definition;

/// Errors: a wish that only skills of other servers can be asked for.
Result<void> checkWishes(const composition::Use& use, const std::string& server) {
    if (!use.server.empty() && use.server != server) {
        return fail(Errc::invalid_argument,
                    fmt::format("server \"{}\" is not this one, \"{}\"; skills of others are for a "
                                "server of kind composition",
                                use.server, server));
    }
    return checkOwn(use);
}

/// Errors: none of that type, or several; those that there are.
Result<skill::Program*> choose(const composition::Use& use,
                               const std::vector<skill::Program*>& programs) {
    skill::Program* found = nullptr;
    std::string names;
    for (auto* program : programs) {
        const auto& description = program->description();
        names += (names.empty() ? "" : ", ") + description.name;
        const bool fits = description.type == use.type || description.type + "Type" == use.type;
        if (fits && found != nullptr) {
            return fail(Errc::invalid_argument,
                        fmt::format("both {} and {} are of type {}", found->description().name,
                                    description.name, use.type));
        }
        found = fits ? program : found;
    }
    if (found == nullptr) {
        return fail(Errc::not_found, fmt::format("this server has no skill of type {}; it has: {}",
                                                 use.type, names));
    }
    return found;
}

Result<std::map<std::string, skill::Program*>> chooseAll(
    const Definition& definition, const std::vector<skill::Program*>& programs,
    const std::string& server) {
    std::map<std::string, skill::Program*> chosen;
    std::string problems;
    for (const auto& use : definition.uses) {
        const auto program =
            checkWishes(use, server).and_then([&] { return choose(use, programs); });
        if (program) {
            chosen.emplace(use.alias, *program);
        } else if (!use.optional || program.error().code != Errc::not_found) {
            problems += fmt::format("{}{}:{}: uses.{}: {}", problems.empty() ? "" : "\n",
                                    definition.file, use.line, use.alias, program.error().message);
        }
    }
    if (!problems.empty()) {
        return fail(Errc::invalid_argument, std::move(problems));
    }
    return chosen;
}

Result<void> publishUses(SkillHost& host, const opcua::NodeId& skills, const std::string& user,
                         const std::map<std::string, skill::Program*>& used) {
    METIER_ASSIGN(const auto from, opcua_skill::findSkillObject(host.nodes(), skills, user));
    for (const auto& [alias, program] : used) {
        METIER_ASSIGN(const auto to, opcua_skill::findSkillObject(host.nodes(), skills,
                                                                  program->description().name));
        METIER_TRY(opcua_skill::publishUse(host.nodes(), from, to));
    }
    return {};
}

Result<void> offerOne(SkillHost& host, const opcua::NodeId& skills, const Definition& definition,
                      const std::string& server) {
    METIER_ASSIGN(const auto chosen, chooseAll(definition, host.skills().programs(), server));
    UsedSkills used_skills;
    for (const auto& [alias, program] : chosen) {
        used_skills.emplace(alias, usedOf(host, *program, definition.name));
    }
    METIER_TRY(publishSequence(host, skills,
                               {definition, std::move(used_skills),
                                fmt::format("{}.{}~{}", server, definition.name, newLife())}));
    return publishUses(host, skills, definition.name, chosen);
}

}  // namespace

Result<std::vector<composition::Definition>> loadDefinitions(
    const std::vector<std::filesystem::path>& files) {
    std::vector<composition::Definition> definitions;
    std::string problems;
    for (const auto& file : files) {
        auto definition = composition::loadDefinition(file);
        if (definition) {
            definitions.push_back(std::move(*definition));
        } else {
            problems += (problems.empty() ? "" : "\n") + definition.error().message;
        }
    }
    if (!problems.empty()) {
        return fail(Errc::invalid_argument, std::move(problems));
    }
    return composition::inOrderOfUse(std::move(definitions));
}

namespace {

/// A type that no model has is that of the composition; terms belong to it.
Result<void> declareOwnType(SkillHost& host, const Definition& definition,
                            const skill::SkillDescription& description) {
    if (!opcua_skill::hasSkillType(host.nodes(), definition.type)) {
        return opcua_skill::declareTypes(host.nodes(),
                                         composition::skillTypesOf(definition, description));
    }
    if (!definition.terms.empty()) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: terms belong to a type of its own, and the server has a type "
                                "{}",
                                definition.file, definition.type));
    }
    return {};
}

}  // namespace

std::string newLife() {
    constexpr std::size_t kDigits = 6;
    return randomHex(kDigits);
}

std::unique_ptr<composition::UsedSkill> usedOf(SkillHost& host, skill::Program& program,
                                               const std::string& composed) {
    return std::make_unique<composition::LocalUsedSkill>(
        program, host.skills().executor(),
        skill::Caller{.session_id = "composition " + composed,
                      .client_name = composed,
                      .of_this_server = true});
}

namespace {

composition::Descriptions descriptionsOf(const Sequence& sequence) {
    composition::Descriptions descriptions;
    for (const auto& [alias, used] : sequence.used_skills) {
        descriptions.emplace(alias, used->description());
    }
    for (const auto& use : sequence.definition.uses) {
        if (use.optional && !descriptions.contains(use.alias)) {
            spdlog::info("{}: no skill serves {} ({}), its steps are left out",
                         sequence.definition.name, use.alias, use.type);
        }
    }
    return descriptions;
}

}  // namespace

Result<composition::SequenceSkill*> publishSequence(SkillHost& host, const opcua::NodeId& skills,
                                                    Sequence sequence) {
    const auto descriptions = descriptionsOf(sequence);
    METIER_ASSIGN(auto composed, composition::compose(sequence.definition, descriptions));
    METIER_TRY(declareOwnType(host, sequence.definition, composed.description));
    auto made = std::make_unique<composition::SequenceSkill>(
        std::move(composed), std::move(sequence.used_skills),
        composition::SequenceSkill::Host{host.skills().executor(), host.clock(),
                                         std::move(sequence.origin)});
    auto* const skill = made.get();
    METIER_TRY(
        host.skills().publish(skills, std::move(made),
                              {.control = host.control(),
                               .names = host.names(),
                               .rest_deadline = composition::restDeadlineOf(sequence.definition)}));
    METIER_ASSIGN(const auto object,
                  opcua_skill::findSkillObject(host.nodes(), skills, sequence.definition.name));
    METIER_TRY(opcua_skill::publishRecipe(host.nodes(), object, sequence.definition.text));
    return skill;
}

Result<void> offerOwnCompositions(SkillHost& host, const opcua::NodeId& skills,
                                  const OwnCompositions& own) {
    METIER_ASSIGN(const auto definitions, loadDefinitions(own.files));
    for (const auto& definition : definitions) {
        METIER_TRY(offerOne(host, skills, definition, own.server));
    }
    return {};
}

}  // namespace metier::server
