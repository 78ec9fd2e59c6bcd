#pragma once

#include <cstddef>

namespace metier {

/// Number of calls of operator new on this thread so far, in a program that links
/// metier::base_testing. A test compares two readings to show that a call did not allocate.
std::size_t allocationCount() noexcept;

}  // namespace metier
