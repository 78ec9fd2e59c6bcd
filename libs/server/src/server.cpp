#include "metier/server/server.hpp"

#include <fmt/format.h>

#include <utility>
#include <variant>

#include "host/announcement.hpp"
#include "kinds/arm_server.hpp"
#include "kinds/composition_server.hpp"
#include "kinds/gripper_server.hpp"
#include "kinds/move_server.hpp"
#include "kinds/synchronized_server.hpp"
#include "metier/base/overloaded.hpp"
#include "metier/server/user_folders.hpp"

namespace metier::server {

Result<std::unique_ptr<Server>> start(const cell::ServerConfig& config, const Context& context) {
    using Started = Result<std::unique_ptr<Server>>;
    return std::visit(overloaded{[&](const cell::ArmServer& arm) -> Started {
                                     return ArmServer::start(config, arm, context);
                                 },
                                 [&](const cell::GripperServer& gripper) -> Started {
                                     return GripperServer::start(config, gripper, context);
                                 },
                                 [&](const cell::MoveComponent& move) -> Started {
                                     return MoveServer::start(config, move, context);
                                 },
                                 [&](const cell::CompositionServer& composition) -> Started {
                                     return CompositionServer::start(config, composition, context);
                                 },
                                 [&](const cell::SynchronizedServer& arms) -> Started {
                                     return SynchronizedServer::start(config, arms, context);
                                 }},
                      config.kind);
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
