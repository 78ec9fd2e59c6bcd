#include "metier/server/server.hpp"

#include <fmt/format.h>

#include <utility>
#include <variant>

#include "host/announcement.hpp"
#include "kinds/kinds.hpp"
#include "metier/server/user_folders.hpp"

namespace metier::server {

Result<std::unique_ptr<Server>> start(const cell::ServerConfig& config, const Context& context) {
    return std::visit([&](const auto& kind) { return serve(config, kind, context); }, config.kind);
}

Result<Identity> identityOf(const cell::ServerConfig& config, const Security& security) {
    std::vector<std::string> hosts{hostName()};
    for (const auto& host : {config.address, config.discovery.announce_as}) {
        const bool names_one = !host.empty() && host != "0.0.0.0";
        if (names_one && host.find(':') == std::string::npos) {
            hosts.push_back(host);
        }
    }
    return Identity::create(
        security, config.port == 0 ? config.name : fmt::format("{}-{}", config.name, config.port),
        {.application_name = "metier " + config.name,
         .application_uri = applicationUriOf(config),
         .hosts = std::move(hosts)});
}

}  // namespace metier::server
