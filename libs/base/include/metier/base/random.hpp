#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace metier {

// Numbers of the system's generator, which nobody can guess. Threads: any. They throw
// std::system_error if the system has none.

/// 64 random bits.
std::uint64_t randomNumber();

/// Random digits 0 to 9 and a to f, 4 bits each.
std::string randomHex(std::size_t digits);

}  // namespace metier
