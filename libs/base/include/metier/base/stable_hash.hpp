#pragma once

#include <cstdint>
#include <string_view>

namespace metier {

/// Hash (FNV-1a, 64 bits) that is the same in every program and on every machine; std::hash does
/// not promise that. Not for secrets: anybody can make two texts with the same hash.
///
/// Threads: any; pure.
/// \return 0xcbf29ce484222325 for an empty text
/// Letters are taken as bytes, so upper and lower case differ.
constexpr std::uint64_t stableHash(std::string_view text) noexcept {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char letter : text) {
        hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3U;
    }
    return hash;
}

}  // namespace metier
