#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::netft_driver {

/// Most that a page may have.
inline constexpr std::size_t kLargestPage = 65'536;

/// The page at http://host:port/path, by HTTP/1.0. Blocks until the deadline at most.
/// Errors: connection_lost, timeout; not_found if the answer is not 200; invalid_argument if it is
///         no HTTP, too large, or shorter than it says.
Result<std::string> httpGet(const std::string& host, std::uint16_t port, const std::string& path,
                            SteadyTime deadline);

/// Reads a part of an answer; its error connection_lost is the answer's end.
using ReceiveSome = std::function<Result<std::size_t>(std::span<std::byte>)>;

/// The body of an answer, of which no more is read than belongs to it.
/// Errors: not_found if the answer is not 200; invalid_argument if it is no HTTP, too large, or
///         shorter than it says; those of `receive`.
Result<std::string> readHttpAnswer(const ReceiveSome& receive);

}  // namespace metier::netft_driver
