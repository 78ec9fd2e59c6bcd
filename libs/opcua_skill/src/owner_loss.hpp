#pragma once

#include <fmt/format.h>

#include <cstdint>

#include "metier/base/error.hpp"
#include "metier/skill/state.hpp"

namespace metier::opcua_skill {

/// OwnerLossAction of the Metier NodeSet has the same numbers.
/// Errors: out_of_range.
inline Result<skill::OwnerLossAction> ownerLossActionFrom(std::int32_t value) {
    constexpr auto kLast = static_cast<std::int32_t>(skill::OwnerLossAction::keep_going);
    if (value < 0 || value > kLast) {
        return fail(Errc::out_of_range,
                    fmt::format("OnOwnerLoss: {} is not within 0 to {}", value, kLast));
    }
    return static_cast<skill::OwnerLossAction>(value);
}

}  // namespace metier::opcua_skill
