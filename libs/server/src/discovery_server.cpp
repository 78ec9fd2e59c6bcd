#include "metier/server/discovery_server.hpp"

#include <fmt/format.h>

#include <utility>

#include "host/server_access.hpp"
#include "metier/opcua/server.hpp"
#include "metier/server/user_folders.hpp"

namespace metier::server {

Result<std::unique_ptr<DiscoveryServer>> DiscoveryServer::start(const Options& options,
                                                                const Identity& identity) {
    opcua::ServerOptions server_options;
    server_options.application_name = "metier discovery";
    server_options.application_uri = "urn:metier:discovery";
    server_options.port = options.port;
    server_options.bind_addresses = {options.address};
    server_options.discovery = opcua::DiscoveryService{.forget_after = options.forget_after};
    std::unique_ptr<DiscoveryServer> made(new DiscoveryServer);
    METIER_ASSIGN(made->access_, secureServer(server_options, identity, made->clock_));
    METIER_ASSIGN(made->server_, opcua::Server::create(std::move(server_options)));
    if (made->access_ != nullptr) {
        made->access_->follow(*made->server_);
    }
    METIER_TRY(made->server_->start());
    if (made->access_ == nullptr) {
        identity.security().noteServedOpen(made->url());
    }
    return made;
}

DiscoveryServer::DiscoveryServer() = default;
DiscoveryServer::~DiscoveryServer() = default;

std::string DiscoveryServer::url() const {
    return server_->endpointUrl();
}

Result<Identity> identityOf(const DiscoveryServer::Options& options, const Security& security) {
    return Identity::create(
        security, options.port == 0 ? "discovery" : fmt::format("discovery-{}", options.port),
        {.application_name = "metier discovery",
         .application_uri = fmt::format("urn:{}:metier:discovery:{}", hostName(), options.port),
         .hosts = {hostName(), options.address}});
}

}  // namespace metier::server
