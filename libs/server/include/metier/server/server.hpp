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

/// Surroundings of servers, besides their configuration. All of it must outlive them.
struct Context {
    const Identity& identity;
    std::span<const device::Driver> drivers;  ///< one of them has the device
    const link::StopSignal& stop;          ///< ends a start that waits for other servers
};

/// A server of a cell: an OPC UA server with skills, and all that goes with it. Its destructor
/// brakes what moves and ends it.
///
/// Threading: one thread at a time makes, asks and ends it.
class Server {
public:
    virtual ~Server() = default;
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    /// Where it listens: "opc.tcp://127.0.0.1:4841".
    virtual std::string url() const = 0;

protected:
    Server() = default;
};

/// Starts a server of a cell; it serves once this returns. A server whose skills are those of
/// others waits for these, 20 s at most.
/// \param config with the addresses of all that it uses, see cell::CellConfig::resolved()
/// Errors: what is wrong with the model, the driver, the NodeSet, the skills, the files, the port;
///         a used server that cannot be reached; cancelled (a stop was asked for).
Result<std::unique_ptr<Server>> start(const cell::ServerConfig& config,
                                      const Context& context);

/// The identity of a server: name, port and hosts of its configuration. A server at another port is
/// another application.
/// Errors: those of Identity::create().
Result<Identity> identityOf(const cell::ServerConfig& config, const Security& security);

}  // namespace metier::server
