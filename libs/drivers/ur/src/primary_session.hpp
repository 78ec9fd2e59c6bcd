#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/link/tcp_link.hpp"
#include "primary.hpp"

namespace metier::ur_driver {

/// A connection to the primary client interface that only listens.
///
/// Errors name the peer. Threading: one thread.
class PrimarySession {
public:
    /// Errors: connection_lost, timeout.
    static Result<PrimarySession> connect(const std::string& host, std::uint16_t port,
                                          SteadyTime deadline);
    /// The next package. Errors: timeout, connection_lost, invalid_argument (garbage).
    Result<primary::Package> next(SteadyTime deadline);

private:
    explicit PrimarySession(link::TcpLink link);

    link::TcpLink link_;
    StreamBuffer buffer_;
};

/// Description that a controller sends when a client connects to its primary interface.
struct ControllerDescription {
    std::optional<primary::Version> version;
    std::optional<primary::Kinematics> kinematics;
    std::optional<primary::Configuration> configuration;

    bool complete() const noexcept { return version && kinematics && configuration; }
    /// Takes the content of a package.
    void take(const primary::Package& package);
};

/// Connects and listens until the description is complete or the deadline passed.
/// \return the received description, perhaps incomplete
/// Errors: connection_lost, timeout if there was nothing.
Result<ControllerDescription> readDescription(const std::string& host, std::uint16_t port,
                                              SteadyTime deadline);

/// Listens for as long as it lives, on a thread of its own; connects again by itself.
class PrimaryMonitor {
public:
    using Handler = std::function<void(const primary::Package&)>;
    /// \param handler called for every package, on the monitor's thread
    PrimaryMonitor(std::string host, std::uint16_t port, Handler handler);

private:
    void run(const std::stop_token& stop);
    void listen(PrimarySession& session, const std::stop_token& stop);

    const std::string host_;
    const std::uint16_t port_;
    const Handler handler_;
    std::jthread thread_;
};

}  // namespace metier::ur_driver
