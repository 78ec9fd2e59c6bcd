#pragma once

#include <cstddef>

namespace metier::motion {

/// How often operator new was called in this program.
std::size_t allocationCount() noexcept;

}  // namespace metier::motion
