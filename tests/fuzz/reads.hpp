#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace metier::fuzz {

/// Gives `take` an input as it could arrive: its first byte says how long each read is.
template <typename Take>
void inReads(std::span<const std::byte> input, Take take) {
    if (input.empty()) {
        return;
    }
    const auto longest = std::to_integer<std::size_t>(input.front()) + 1;
    for (auto rest = input.subspan(1); !rest.empty();) {
        const auto read = rest.first(std::min(longest, rest.size()));
        take(read);
        rest = rest.subspan(read.size());
    }
}

}  // namespace metier::fuzz
