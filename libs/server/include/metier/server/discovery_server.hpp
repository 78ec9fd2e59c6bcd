#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/server/identity.hpp"

namespace metier::opcua {
class Server;
}  // namespace metier::opcua

namespace metier::server {

class ServerAccess;

/// A Local Discovery Server (OPC 10000-12): servers register there, and clients ask it for the
/// registered servers.
///
/// Threading: one thread makes and ends it; a thread of its own serves.
class DiscoveryServer {
public:
    /// Settings of a discovery server.
    struct Options {
        /// TCP port, by default the standard one of OPC 10000-12; 0: a free one.
        std::uint16_t port = 4840;
        /// Address to listen on; in an insecure lab a loopback address.
        std::string address = "127.0.0.1";
        /// Time after which a registration that is not renewed is forgotten; at least 1 s.
        std::chrono::seconds forget_after{75};
    };

    /// Starts serving before it returns.
    /// \param identity must outlive the result
    /// Errors: invalid_argument (the address), resource_unavailable (the port); those of
    /// Security::openFolder().
    static Result<std::unique_ptr<DiscoveryServer>> start(const Options& options,
                                                          const Identity& identity);
    /// Ends the server; its registrations are gone.
    ~DiscoveryServer();
    DiscoveryServer(const DiscoveryServer&) = delete;
    DiscoveryServer& operator=(const DiscoveryServer&) = delete;

    /// Endpoint address with the real port: "opc.tcp://127.0.0.1:4840".
    std::string url() const;

private:
    DiscoveryServer();

    const SystemClock clock_{};
    std::unique_ptr<ServerAccess> access_;  // none in an insecure lab
    std::unique_ptr<opcua::Server> server_;
};

/// Makes the identity of a discovery server. At another port it is another application.
/// Errors: those of Identity::create().
Result<Identity> identityOf(const DiscoveryServer::Options& options, const Security& security);

}  // namespace metier::server
