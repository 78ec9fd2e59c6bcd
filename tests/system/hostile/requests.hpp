#pragma once

#include <cstdint>
#include <span>

#include "known.hpp"

namespace metier::hostile {

/// Writer of a request's content after its RequestHeader.
using WriteBody = void (*)(Writer&, const Known&);

struct Request {
    std::uint32_t type;  ///< id of its Binary encoding (OPC 10000-6, annex A)
    WriteBody write;
    std::size_t weight;  ///< frequency, relative to the others
};

/// All services of OPC 10000-4 but those that open and close channels and sessions.
std::span<const Request> attributeRequests();
std::span<const Request> nodeRequests();
std::span<const Request> subscriptionRequests();
std::span<const Request> discoveryRequests();

/// One of all of them; or one that no server has.
const Request& anyRequest(Random& random);

/// The whole message: type, RequestHeader, body.
Bytes message(Writer writer, const Request& request, const Known& known);

/// OpenSecureChannel, CreateSession, ActivateSession and CloseSession.
enum class Renewal { issue, renew };
Bytes openSecureChannel(Writer writer, Renewal renewal);
Bytes createSession(Writer writer, const Known& known);
Bytes activateSession(Writer writer, const Known& known);
Bytes closeSession(Writer writer, const Known& known);

}  // namespace metier::hostile
