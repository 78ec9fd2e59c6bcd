#include "metier/base/text.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace metier {
namespace {

constexpr std::size_t kLongestSequence = 4;

/// Changes the letters of `from` to `to`, without a locale.
std::string shifted(std::string_view text, char from, char to) {
    constexpr int kLetters = 26;
    std::string result(text);
    for (char& letter : result) {
        if (letter >= from && letter < from + kLetters) {
            letter = static_cast<char>(letter - from + to);
        }
    }
    return result;
}

/// Number of bytes of a sequence that begins with `lead`, more than 4 if none does.
std::size_t sequenceLength(std::uint8_t lead) noexcept {
    const auto ones = static_cast<std::size_t>(std::countl_one(lead));
    return ones == 0 ? 1 : (ones == 1 ? kLongestSequence + 1 : ones);
}

}  // namespace

std::string_view trimmed(std::string_view text, std::string_view blanks) noexcept {
    text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
    return text.substr(0, text.find_last_not_of(blanks) + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (bool more = !text.empty(); more;) {
        const auto end = text.find(separator);
        parts.push_back(text.substr(0, end));
        more = end != std::string_view::npos;
        text.remove_prefix(more ? end + 1 : text.size());
    }
    return parts;
}

std::string inLowerCase(std::string_view text) {
    return shifted(text, 'A', 'a');
}

std::string inUpperCase(std::string_view text) {
    return shifted(text, 'a', 'A');
}

std::optional<Utf8Character> firstCharacter(std::string_view text) noexcept {
    constexpr std::array<std::uint32_t, 5> kLeadMask{0, 0x7F, 0x1F, 0x0F, 0x07};
    constexpr std::array<std::uint32_t, 5> kSmallest{0, 0, 0x80, 0x800, 0x10000};
    if (text.empty()) {
        return std::nullopt;
    }
    const auto size = sequenceLength(static_cast<std::uint8_t>(text.front()));
    if (size > kLongestSequence || size > text.size()) {
        return std::nullopt;
    }
    std::uint32_t point = static_cast<std::uint8_t>(text.front()) & kLeadMask[size];
    for (const char character : text.substr(1, size - 1)) {
        const auto byte = static_cast<std::uint8_t>(character);
        if ((byte & 0xC0U) != 0x80U) {
            return std::nullopt;
        }
        point = point << 6U | (byte & 0x3FU);
    }
    const bool surrogate = point >= 0xD800 && point <= 0xDFFF;
    return point < kSmallest[size] || surrogate || point > 0x10FFFF
               ? std::nullopt
               : std::optional(Utf8Character{point, size});
}

bool isUtf8(std::string_view text) noexcept {
    while (!text.empty()) {
        const auto character = firstCharacter(text);
        if (!character) {
            return false;
        }
        text.remove_prefix(character->size);
    }
    return true;
}

}  // namespace metier
