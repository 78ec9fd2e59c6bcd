#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace metier {

// Random numbers of the operating system, which nobody can guess. Threads: any. Both functions
// throw std::system_error if the system has no random numbers.

/// 64 random bits.
std::uint64_t randomNumber();

/// Random digits 0 to 9 and a to f, 4 bits each.
std::string randomHex(std::size_t digits);

}  // namespace metier
