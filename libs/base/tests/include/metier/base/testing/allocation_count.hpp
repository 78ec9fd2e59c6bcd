#pragma once

#include <cstddef>

namespace metier {

/// How often operator new was called on this thread, in a program that links metier::base_testing.
std::size_t allocationCount() noexcept;

}  // namespace metier
