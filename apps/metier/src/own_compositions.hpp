#pragma once

#include <string>

#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/opcua/node_id.hpp"
#include "skill_host.hpp"

namespace metier::app {

/// Publishes the skills that `config.own_compositions` declares, made of the skills that the host
/// offers by now and of each other, below `skills`.
/// Errors: what is wrong with the files; a used skill that the server does not offer, or several.
Result<void> offerOwnCompositions(SkillHost& host, const opcua::NodeId& skills,
                                  const cell::ServerConfig& config);

}  // namespace metier::app
