#pragma once

#include <map>
#include <string>
#include <vector>

#include "finding/skill_matching.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/composition/definition.hpp"
#include "metier/opcua/search.hpp"
#include "metier/server/identity.hpp"

namespace metier::server {

/// A server that was found, and what it offers.
struct DiscoveredServer {
    opcua::FoundServer found;
    std::vector<OfferedSkill> offered;
};

/// Servers that discovery knows now; none of them was connected to yet.
/// \param but addresses to leave out
/// Threads: any; waits, some seconds.
std::vector<opcua::FoundServer> announcedServers(const cell::Discovery& discovery,
                                                 const std::vector<std::string>& but);

/// Those that answer within 2 s, by name and address, with what they offer.
/// \param but addresses to leave out
/// Threads: any; waits, some seconds.
std::vector<DiscoveredServer> discoverServers(const cell::Discovery& discovery,
                                              const ConnectionSecurity& security,
                                              const std::vector<std::string>& but);

/// Which skill of a server serves each of these uses, by alias.
/// Errors: those of choose(), of the first use that it cannot serve.
Result<std::map<std::string, OfferedSkill>> chooseAll(const std::vector<composition::Use>& uses,
                                                      const DiscoveredServer& server);

/// Assignment of uses to servers. The server that can serve most of them comes first, as the skills
/// of one arm belong together; then the order of the servers decides.
struct Assignment {
    const DiscoveredServer* server = nullptr;
    std::vector<composition::Use> uses;
};

/// Errors: not_found, with a line "uses.ALIAS: why" for each use that no server can serve.
Result<std::vector<Assignment>> assign(const std::vector<composition::Use>& uses,
                                       const std::vector<DiscoveredServer>& servers);

}  // namespace metier::server
