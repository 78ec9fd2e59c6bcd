#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/composition/definition.hpp"
#include "metier/composition/sequence_skill.hpp"
#include "metier/opcua/node_id.hpp"
#include "metier/skill/program.hpp"

namespace metier::server {

class SkillHost;

/// All files, each after those that it uses.
/// Errors: everything that is wrong with any of them.
Result<std::vector<composition::Definition>> loadDefinitions(
    const std::vector<std::filesystem::path>& files);

/// Distinguishes the executions of this life of a server from those before.
std::string newLife();

using UsedSkills = std::map<std::string, std::unique_ptr<composition::UsedSkill>>;  ///< by alias

/// A skill of the host, for the composed skill of that name.
std::unique_ptr<composition::UsedSkill> usedOf(SkillHost& host, skill::Program& program,
                                               const std::string& composed);

/// A skill that a file declares, with the skills that it uses.
struct Sequence {
    const composition::Definition& definition;
    UsedSkills used_skills;
    std::string origin;  ///< as composition::SequenceSkill takes it
};

/// Publishes the skill below `skills`; it is the host's.
/// Errors: mistakes in the definition; those of SkillServer::publish().
Result<composition::SequenceSkill*> publishSequence(SkillHost& host, const opcua::NodeId& skills,
                                                    Sequence sequence);

/// Skills that files declare for one server.
struct OwnCompositions {
    const std::string& server;  ///< its name
    const std::vector<std::filesystem::path>& files;
};

/// Publishes the skills of `own`, made of the skills that the host offers by now and of each other,
/// below `skills`.
/// Errors: what is wrong with the files; a used skill that the server does not offer, or several.
Result<void> offerOwnCompositions(SkillHost& host, const opcua::NodeId& skills,
                                  const OwnCompositions& own);

}  // namespace metier::server
