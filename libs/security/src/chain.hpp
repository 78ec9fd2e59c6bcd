#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "metier/security/audit_log.hpp"

namespace metier::security {

/// Chain value before the first line of a log.
inline constexpr std::string_view kNoChain =
    "0000000000000000000000000000000000000000000000000000000000000000";

/// A line without its end, and what the next is chained to.
struct ChainedLine {
    std::string text;
    std::string chain;
};

/// The first line of a part that follows another one.
inline constexpr std::string_view kContinued = "Continued";
inline constexpr std::string_view kAfter = "after";

ChainedLine chainLine(const Entry& entry, std::uint64_t number, std::string_view chain_before);

struct ReadLine {
    std::uint64_t number = 0;
    std::string time;
    std::string chain;
    std::string after;  ///< in the first line of a part: last chain value of the part before
};
/// Nothing unless it is just as chainLine() wrote it after that one.
std::optional<ReadLine> readLine(std::string_view text, std::string_view chain_before);
/// The same, without a look at the line before.
std::optional<ReadLine> readLastLine(std::string_view text);

}  // namespace metier::security
