#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace metier::opcua_skill {

/// Safety state of a controller as published, with the numbers of the Metier NodeSet's
/// SafetyStateKind. Observed, never commanded.
enum class SafetyStateKind : std::int32_t {
    unknown = 0,  ///< also of a device without a connection
    normal = 1,
    reduced = 2,  ///< the arm may move within reduced limits
    protective_stop = 3,
    emergency_stop = 4,
    fault = 5,
};

/// Name of the value as in the NodeSet, "ProtectiveStop"; "Unknown" for a number that is none.
constexpr std::string_view nameOf(SafetyStateKind kind) noexcept {
    constexpr std::array<std::string_view, 6> kNames{"Unknown",        "Normal",        "Reduced",
                                                     "ProtectiveStop", "EmergencyStop", "Fault"};
    const auto index = static_cast<std::size_t>(kind);
    return index < kNames.size() ? kNames[index] : kNames.front();
}

}  // namespace metier::opcua_skill
