#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace metier::opcua_skill {

/// Safety state of a controller as published, with the numbers of the Metier NodeSet's
/// SafetyStateKind. Observed, never commanded.
/// The numbers are read by clients: they never change.
enum class SafetyStateKind : std::int32_t {
    /// Not known; also of a device without a connection.
    unknown = 0,
    /// The arm may move.
    normal = 1,
    /// The arm may move within reduced limits.
    reduced = 2,
    /// The controller stopped the arm; a Reset ends it.
    protective_stop = 3,
    /// The button is pressed.
    emergency_stop = 4,
    /// The controller needs a person.
    fault = 5,
};

/// Name of the value as in the NodeSet, "ProtectiveStop"; "Unknown" for a number that is none.
/// Threads: any; pure.
constexpr std::string_view nameOf(SafetyStateKind kind) noexcept {
    constexpr std::array<std::string_view, 6> kNames{"Unknown",        "Normal",        "Reduced",
                                                     "ProtectiveStop", "EmergencyStop", "Fault"};
    const auto index = static_cast<std::size_t>(kind);
    return index < kNames.size() ? kNames[index] : kNames.front();
}

}  // namespace metier::opcua_skill
