#pragma once

#include <cstdint>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/link/tcp_link.hpp"
#include "rtde.hpp"

namespace metier::ur_driver {

/// Parameters of a session over RTDE.
struct RtdeRequest {
    std::string host;
    std::uint16_t port = 30004;
    double frequency = 125.0;         ///< [Hz]
    std::int32_t register_base = 24;  ///< as in rtde::Setpoint
};

/// A connection over RTDE on which data packages flow.
///
/// Errors name the peer. Threading: one thread.
class RtdeSession {
public:
    /// Connects, agrees on version 2 and the variables, and starts the packages. The token register
    /// is set to 0, so that a script that still runs ends.
    /// Errors: connection_lost, timeout, not_supported (an old version, variables or the frequency
    ///         that the controller does not offer), resource_unavailable (registers in use),
    ///         invalid_argument (garbage).
    static Result<RtdeSession> open(const RtdeRequest& request, SteadyTime deadline);

    /// Waits for the next data package. Does not allocate if there is no error.
    /// Errors: timeout, connection_lost, invalid_argument.
    Result<ControllerState> next(SteadyTime deadline);
    /// Errors: connection_lost, timeout. Does not allocate if there is none.
    Result<void> write(const rtde::Setpoint& setpoint, SteadyTime deadline);
    /// Takes the token away from a script that still runs and pauses the data packages. A failure
    /// is ignored: the connection is over then anyway.
    void end(SteadyTime deadline);

private:
    RtdeSession(link::TcpLink link, std::int32_t register_base);

    Result<void> negotiate(const RtdeRequest& request, SteadyTime deadline);
    Result<void> setUpOutputs(double frequency, SteadyTime deadline);
    Result<void> setUpInputs(std::int32_t register_base, SteadyTime deadline);
    /// Sends a request and takes the payload of the answer of the same type.
    Result<rtde::Bytes> ask(const rtde::Bytes& request, SteadyTime deadline);
    /// The next package that is no text message; consumed at the next call.
    Result<rtde::Package> nextPackage(SteadyTime deadline);
    void tell(const rtde::Package& message) const;
    Error atPeer(Error error) const;

    link::TcpLink link_;
    StreamBuffer buffer_;
    std::size_t to_consume_ = 0;
    rtde::OutputRecipe outputs_;
    std::uint8_t input_recipe_ = 0;
};

}  // namespace metier::ur_driver
