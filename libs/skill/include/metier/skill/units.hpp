#pragma once

#include <array>

#include "metier/skill/field.hpp"

namespace metier::skill {

/// All units that fields have, kOne first.
inline constexpr std::array kUnits{kOne,
                                   kMetre,
                                   kRadian,
                                   kSecond,
                                   kNewton,
                                   kNewtonMetre,
                                   kMetrePerSecond,
                                   kRadianPerSecond,
                                   kMetrePerSecondSquared,
                                   kRadianPerSecondSquared,
                                   kKilogram};

}  // namespace metier::skill
