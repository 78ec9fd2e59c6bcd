#include "metier/opcua/text.hpp"

#include <cstddef>
#include <cstdint>

#include "metier/base/text.hpp"

namespace metier::opcua {

namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

/// Code points that move a terminal's cursor or turn the direction of writing.
bool isControl(std::uint32_t point) noexcept {
    return point < 0x20 || (point >= 0x7F && point < 0xA0) ||
           (point >= 0x202A && point <= 0x202E) || (point >= 0x2066 && point <= 0x2069) ||
           point == 0x2028 || point == 0x2029;
}

}  // namespace

std::string sanitise(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    while (!text.empty()) {
        const auto character = firstCharacter(text);
        const std::size_t used = character ? character->size : 1;
        result +=
            !character || isControl(character->code_point) ? kReplacement : text.substr(0, used);
        text.remove_prefix(used);
    }
    return result;
}

}  // namespace metier::opcua
