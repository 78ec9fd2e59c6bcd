#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/skill_host.hpp"
#include "metier/base/error.hpp"
#include "metier/opcua/node_id.hpp"

namespace metier::server {

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
