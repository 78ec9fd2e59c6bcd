#pragma once

#include <array>

namespace metier::virtual_iiwa {

/// What the cabinet has of an impedance or oscillation setting (221 to 243) after it was told
/// `arguments`: an entry out of its range stays as it was `before`, a negative limit of 224 to 226
/// is as good as none.
std::array<double, 7> impedanceAfter(int code, const std::array<double, 7>& before,
                                     const std::array<double, 7>& arguments) noexcept;

}  // namespace metier::virtual_iiwa
