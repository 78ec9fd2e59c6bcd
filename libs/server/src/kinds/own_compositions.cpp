#include "kinds/own_compositions.hpp"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "finding/skill_matching.hpp"
#include "kinds/composition_files.hpp"
#include "metier/composition/composition.hpp"
#include "metier/composition/local_used_skill.hpp"
#include "metier/composition/sequence_skill.hpp"
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
        } else {
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

Result<void> offerOne(SkillHost& host, const opcua::NodeId& skills, Definition definition,
                      const std::string& server) {
    const auto name = definition.name;
    METIER_ASSIGN(const auto chosen, chooseAll(definition, host.skills().programs(), server));
    const auto executor = host.skills().executor();
    composition::Descriptions descriptions;
    std::map<std::string, std::unique_ptr<composition::UsedSkill>> used_skills;
    for (const auto& [alias, program] : chosen) {
        descriptions.emplace(alias, program->description());
        used_skills.emplace(alias, std::make_unique<composition::LocalUsedSkill>(
                                       *program, executor,
                                       skill::Caller{.session_id = "composition " + name,
                                                     .client_name = name,
                                                     .of_this_server = true}));
    }
    METIER_ASSIGN(auto composed, composition::compose(definition, descriptions));
    const skill::ProgramOptions options{.control = host.control(),
                                        .names = host.names(),
                                        .rest_deadline = composition::restDeadlineOf(definition)};
    auto origin = fmt::format("{}.{}~{}", server, name, newLife());
    const auto published = host.skills().publish(
        skills,
        std::make_unique<composition::SequenceSkill>(std::move(composed), std::move(used_skills),
                                                     executor, host.clock(), std::move(origin)),
        options);
    return published ? publishUses(host, skills, name, chosen) : fail(published.error());
}

}  // namespace

Result<void> offerOwnCompositions(SkillHost& host, const opcua::NodeId& skills,
                                  const OwnCompositions& own) {
    METIER_ASSIGN(auto definitions, loadDefinitions(own.files));
    for (auto& definition : definitions) {
        METIER_TRY(offerOne(host, skills, std::move(definition), own.server));
    }
    return {};
}

}  // namespace metier::server
