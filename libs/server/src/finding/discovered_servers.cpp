#include "finding/discovered_servers.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "metier/server/skill_survey.hpp"

namespace metier::server {
namespace {

std::size_t servedBy(const DiscoveredServer& server, const std::vector<composition::Use>& uses) {
    return static_cast<std::size_t>(
        std::count_if(uses.begin(), uses.end(), [&](const composition::Use& use) {
            return choose(use, server.offered, Derived::left_out).has_value();
        }));
}

}  // namespace

std::vector<opcua::FoundServer> announcedServers(const cell::Discovery& discovery,
                                                 const std::vector<std::string>& but) {
    auto sighting = opcua::searchServers(
        discovery.servers, discovery.mdns ? opcua::Mdns::asked : opcua::Mdns::left_out);
    for (const auto& problem : sighting.problems) {
        spdlog::debug("{}", problem.message);
    }
    std::erase_if(sighting.servers, [&](const opcua::FoundServer& server) {
        return std::find(but.begin(), but.end(), server.url) != but.end();
    });
    return std::move(sighting.servers);
}

std::vector<DiscoveredServer> discoverServers(const cell::Discovery& discovery,
                                              const ConnectionSecurity& security,
                                              const std::vector<std::string>& but) {
    const auto announced = announcedServers(discovery, but);
    std::vector<DiscoveredServer> servers;
    for (auto& surveyed : survey(announced, security)) {
        if (!surveyed.skills) {
            spdlog::debug("{}: {}", surveyed.server.url, surveyed.skills.error().message);
            continue;
        }
        DiscoveredServer server{surveyed.server, {}};
        const auto& name = surveyed.server.name.empty() ? server.found.url : server.found.name;
        for (auto& skill : *surveyed.skills) {
            server.offered.push_back({name, 0, std::move(skill.address), skill.arm});
        }
        servers.push_back(std::move(server));
    }
    return servers;
}

Result<std::map<std::string, OfferedSkill>> chooseAll(const std::vector<composition::Use>& uses,
                                                      const DiscoveredServer& server) {
    std::map<std::string, OfferedSkill> chosen;
    for (const auto& use : uses) {
        METIER_ASSIGN(auto skill, choose(use, server.offered, Derived::left_out));
        chosen.emplace(use.alias, std::move(skill));
    }
    return chosen;
}

Result<std::vector<Assignment>> assign(const std::vector<composition::Use>& uses,
                                       const std::vector<DiscoveredServer>& servers) {
    std::vector<Assignment> assignments;
    assignments.reserve(servers.size());
    for (const auto& server : servers) {
        assignments.push_back({&server, {}});
    }
    std::stable_sort(assignments.begin(), assignments.end(), [&](const auto& a, const auto& b) {
        return servedBy(*a.server, uses) > servedBy(*b.server, uses);
    });
    std::vector<OfferedSkill> all;
    for (const auto& server : servers) {
        all.insert(all.end(), server.offered.begin(), server.offered.end());
    }
    std::string problems;
    for (const auto& use : uses) {
        const auto taken =
            std::find_if(assignments.begin(), assignments.end(), [&](const Assignment& assignment) {
                return choose(use, assignment.server->offered, Derived::left_out).has_value();
            });
        if (taken != assignments.end()) {
            taken->uses.push_back(use);
        } else if (const auto none = choose(use, all, Derived::left_out).error();
                   !use.optional || none.code != Errc::not_found) {
            problems +=
                fmt::format("{}uses.{}: {}", problems.empty() ? "" : "\n", use.alias, none.message);
        }
    }
    std::erase_if(assignments, [](const Assignment& each) { return each.uses.empty(); });
    return problems.empty() ? Result<std::vector<Assignment>>(std::move(assignments))
                            : fail(Errc::not_found, std::move(problems));
}

}  // namespace metier::server
