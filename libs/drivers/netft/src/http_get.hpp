#pragma once

#include <cstdint>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::netft_driver {

/// The page at http://host:port/path, by HTTP/1.0. Blocks until the deadline at most.
/// Errors: connection_lost, timeout; not_found if the answer is not 200; invalid_argument if it is
///         no HTTP, too large, or shorter than it says.
Result<std::string> httpGet(const std::string& host, std::uint16_t port, const std::string& path,
                            SteadyTime deadline);

}  // namespace metier::netft_driver
