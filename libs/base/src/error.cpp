#include "metier/base/error.hpp"

#include <array>

namespace metier {

std::string_view toString(Errc code) noexcept {
    constexpr std::array<std::string_view, 18> kNames{
        "invalid_argument", "type_mismatch", "out_of_range",
        "unreachable",      "not_found",     "already_exists",
        "invalid_state",    "locked",        "resource_unavailable",
        "access_denied",    "timeout",       "connection_lost",
        "execution_lost",   "device_fault",  "limit_violated",
        "not_supported",    "cancelled",     "internal"};
    static_assert(kNames.size() == static_cast<std::size_t>(Errc::internal) + 1);
    const auto index = static_cast<std::size_t>(code);
    return index < kNames.size() ? kNames[index] : "unknown";
}

}  // namespace metier
