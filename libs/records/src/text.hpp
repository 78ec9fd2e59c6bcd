#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace metier::records {

/// Longest text that a column takes [byte].
inline constexpr std::size_t kLongestText = 65'536;

/// Well-formed UTF-8 without NUL, as both databases take it: what does not fit becomes U+FFFD, and
/// what is beyond kLongestText is cut off.
std::string storable(std::string_view text);

}  // namespace metier::records
