#include "metier/opcua/text.hpp"

#include <cstddef>
#include <cstdint>

namespace metier::opcua {

namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

/// Number of bytes of a sequence that starts with `lead`; 0 if none does.
std::size_t sequenceLength(std::uint8_t lead) noexcept {
    if (lead < 0x80) {
        return 1;
    }
    if (lead >= 0xC2 && lead <= 0xDF) {
        return 2;
    }
    if (lead >= 0xE0 && lead <= 0xEF) {
        return 3;
    }
    return lead >= 0xF0 && lead <= 0xF4 ? 4 : 0;
}

/// The code point at the start of `text`, whose sequence has `length` bytes; 0 if malformed.
std::uint32_t decode(std::string_view text, std::size_t length) noexcept {
    constexpr std::uint32_t kLeadMask[] = {0, 0x7F, 0x1F, 0x0F, 0x07};
    constexpr std::uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
    if (length == 0 || length > text.size()) {
        return 0;
    }
    std::uint32_t point = static_cast<std::uint8_t>(text[0]) & kLeadMask[length];
    for (std::size_t i = 1; i < length; ++i) {
        const auto byte = static_cast<std::uint8_t>(text[i]);
        if ((byte & 0xC0U) != 0x80U) {
            return 0;
        }
        point = point << 6U | (byte & 0x3FU);
    }
    const bool surrogate = point >= 0xD800 && point <= 0xDFFF;
    return point < kSmallest[length] || surrogate || point > 0x10FFFF ? 0 : point;
}

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
        const std::size_t length = sequenceLength(static_cast<std::uint8_t>(text[0]));
        const std::uint32_t point = decode(text, length);
        const std::size_t used = point == 0 ? 1 : length;
        result += isControl(point) ? kReplacement : text.substr(0, used);
        text.remove_prefix(used);
    }
    return result;
}

}  // namespace metier::opcua
