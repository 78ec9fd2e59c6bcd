#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace metier {

// Random numbers of the operating system, which nobody can guess. Threads: any; they wait only
// while a machine that has just started has no random numbers yet. Both functions throw
// std::system_error if the system has none.

/// 64 random bits; every number is possible, 0 included.
std::uint64_t randomNumber();

/// Random digits 0 to 9 and a to f, 4 bits each.
/// 32 digits are 128 bits: enough for a name that nobody guesses or meets twice.
/// \param digits length of the text; 0: an empty text
std::string randomHex(std::size_t digits);

}  // namespace metier
