#pragma once

#include <asio/ip/address.hpp>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::link {

/// Finds the addresses of a host, in the order in which they should be tried; at least one.
///
/// An address is returned unchanged. A name is looked up on a thread of its own, since the system's
/// look-up has no deadline. A look-up that is not answered in time goes on there; until it ends,
/// the same name is not looked up again, and the process waits for it at its own end. The system
/// gives up within half a minute in its usual settings.
/// \param host a name or an IPv4 or IPv6 address
/// Errors:  connection_lost if there is no such host; timeout at the deadline. The texts do not
///          name the host.
/// Threads: any; waits until the deadline at most.
Result<std::vector<asio::ip::address>> addressesOf(const std::string& host, SteadyTime deadline);

}  // namespace metier::link
