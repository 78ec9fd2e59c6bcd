#pragma once

#include <array>

namespace metier::virtual_iiwa {

/// Whether an impedance or oscillation command (221 to 243) has values that the cabinet takes.
bool impedancePossible(int code, const std::array<double, 7>& arguments) noexcept;

}  // namespace metier::virtual_iiwa
