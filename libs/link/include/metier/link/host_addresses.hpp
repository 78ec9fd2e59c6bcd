#pragma once

#include <asio/ip/address.hpp>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::link {

/// Addresses of a host, in the order in which they should be tried; at least one.
///
/// An address is taken as it is. A name is looked up on a thread of its own, since the system's
/// look-up has no deadline: one that is not answered in time goes on there, and while it does, the
/// same name is not looked up again. The process ends after it: the system gives up by itself,
/// within half a minute in its usual settings.
/// \param host a name or an address
/// Errors:  connection_lost if there is no such host; timeout at the deadline. The texts do not
///          name the host.
/// Threads: any; waits.
Result<std::vector<asio::ip::address>> addressesOf(const std::string& host, SteadyTime deadline);

}  // namespace metier::link
