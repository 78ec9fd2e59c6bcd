#pragma once

#include <memory>
#include <span>
#include <string>

#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/device/driver.hpp"
#include "metier/link/stop_signal.hpp"
#include "metier/server/identity.hpp"

namespace metier::server {

/// Surroundings of servers, besides their configuration; must outlive them.
struct Context {
    /// Certificate of the server, and of its connections to others.
    const Identity& identity;
    /// Known drivers, including that of the device: device::drivers().
    std::span<const device::Driver> drivers;
    /// Signal that ends a start that waits for other servers.
    const link::StopSignal& stop;
};

/// A server of a cell: an OPC UA server with skills and all its services. Its destructor brakes the
/// device and ends the server; it waits for both.
///
///     link::StopSignal stop;
///     auto identity = identityOf(config, security);
///     auto server = start(config, {*identity, device::drivers(), stop});
///     stop.wait();
///
/// Threading: create, use and destroy it on one thread at a time.
class Server {
public:
    virtual ~Server() = default;
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    /// Endpoint address with the real port: "opc.tcp://127.0.0.1:4841".
    virtual std::string url() const = 0;

protected:
    Server() = default;
};

/// Starts a server of a cell; it serves once this returns. A server that uses skills of other
/// servers waits for these, 20 s at most.
/// \param config with the addresses of all used servers, see cell::CellConfig::resolved()
/// Errors: mistakes in model, driver, NodeSet, skills and files; a port that is taken; a used
/// server that cannot be reached; cancelled (a stop was asked for).
Result<std::unique_ptr<Server>> start(const cell::ServerConfig& config, const Context& context);

/// Makes the identity of a server from name, port and hosts of its configuration. A server at
/// another port is another application.
/// Errors: those of Identity::create().
Result<Identity> identityOf(const cell::ServerConfig& config, const Security& security);

}  // namespace metier::server
