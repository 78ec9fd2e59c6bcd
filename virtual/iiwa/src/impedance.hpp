#pragma once

#include <array>

namespace metier::virtual_iiwa {

/// Value of an impedance or oscillation setting (221 to 243) in the cabinet after a command with
/// `arguments`: an entry out of its range stays as `before`, a negative limit of 224 to 226 means
/// no limit.
std::array<double, 7> impedanceAfter(int code, const std::array<double, 7>& before,
                                     const std::array<double, 7>& arguments) noexcept;

}  // namespace metier::virtual_iiwa
