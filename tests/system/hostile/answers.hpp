#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "known.hpp"
#include "reader.hpp"

namespace metier::hostile {

/// Longest wait of a well-behaved client for an answer, most of it for the machine's other work;
/// sanitizers take some of the time.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr std::chrono::milliseconds kLongestAnswer{4'000};
#else
inline constexpr std::chrono::milliseconds kLongestAnswer{3'000};
#endif

/// Types of responses, by their Binary encoding.
inline constexpr std::uint32_t kServiceFault = 397;
inline constexpr std::uint32_t kOpenSecureChannelResponse = 449;
inline constexpr std::uint32_t kCreateSessionResponse = 464;
inline constexpr std::uint32_t kActivateSessionResponse = 470;
inline constexpr std::uint32_t kBadSessionIdInvalid = 0x8025'0000;

/// Takes over ids of subscriptions, monitored items and continuation points.
void learn(std::uint32_t type, Reader& content, Known& known);

/// Forbidden effect of a stranger's request on an open server: nodes or references were added or
/// deleted. Empty if there was none.
std::string permitted(std::uint32_t type, std::uint32_t result, std::string_view content);

/// The same of a closed server: anything but discovery.
std::string givenAway(std::uint32_t type, std::uint32_t result);

}  // namespace metier::hostile
