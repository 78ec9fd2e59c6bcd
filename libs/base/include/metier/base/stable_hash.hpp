#pragma once

#include <cstdint>
#include <string_view>

namespace metier {

/// FNV-1a: the same in every program and on every machine, as std::hash need not be.
///
/// Threads: any; pure.
constexpr std::uint64_t stableHash(std::string_view text) noexcept {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char letter : text) {
        hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3U;
    }
    return hash;
}

}  // namespace metier
