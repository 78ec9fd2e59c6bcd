#pragma once

#include <string>

namespace metier::dashboard {

/// 128 bits of the system's random numbers, in hexadecimal: nobody guesses it.
/// Threads: any. Throws std::system_error if the system has none.
std::string randomName();

}  // namespace metier::dashboard
