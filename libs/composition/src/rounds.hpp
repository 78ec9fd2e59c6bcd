#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "metier/base/error.hpp"

namespace metier::composition {

/// Largest number of rounds that a loop may be given.
inline constexpr double kMostRepeats = 1e6;

/// Number of rounds from the value of `times`.
/// Errors: out_of_range, unless it is a whole number from 0 to kMostRepeats.
inline Result<std::uint64_t> wholeRounds(double times) {
    if (!(times >= 0.0 && times <= kMostRepeats) || times != std::floor(times)) {
        return fail(
            Errc::out_of_range,
            fmt::format("times is {}; it needs a whole number from 0 to {}", times, kMostRepeats));
    }
    return static_cast<std::uint64_t>(times);
}

}  // namespace metier::composition
