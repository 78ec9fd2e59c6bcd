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

/// A Local Discovery Server (OPC 10000-12): servers register there, and clients ask it which there
/// are.
///
/// Threading: one thread makes and ends it; a thread of its own serves.
class DiscoveryServer {
public:
    struct Options {
        std::uint16_t port = 4840;              ///< as OPC 10000-12 has it; 0: a free one
        std::string address = "127.0.0.1";      ///< to listen on; of loopback in an insecure lab
        std::chrono::seconds forget_after{75};  ///< servers that did not renew; at least 1 s
    };

    /// Serves once this returns.
    /// \param identity must outlive it
    /// Errors: invalid_argument (the address), resource_unavailable (the port); as
    ///         Security::openFolder().
    static Result<std::unique_ptr<DiscoveryServer>> start(const Options& options,
                                                          const Identity& identity);
    ~DiscoveryServer();
    DiscoveryServer(const DiscoveryServer&) = delete;
    DiscoveryServer& operator=(const DiscoveryServer&) = delete;

    std::string url() const;

private:
    DiscoveryServer();

    const SystemClock clock_;
    std::unique_ptr<ServerAccess> access_;  // none in an insecure lab
    std::unique_ptr<opcua::Server> server_;
};

/// The identity of a discovery server; one at another port is another application.
/// Errors: those of Identity::create().
Result<Identity> identityOf(const DiscoveryServer::Options& options, const Security& security);

}  // namespace metier::server
