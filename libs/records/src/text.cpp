#include "text.hpp"

#include <array>
#include <cstdint>
#include <cstring>

namespace metier::records {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";
// Of each of eight bytes.
constexpr std::uint64_t kHighBits = 0x8080808080808080U;
constexpr std::uint64_t kOnes = 0x0101010101010101U;

bool isContinuation(char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

/// How many bytes the sequence has that begins with `first`; 0: none begins so.
std::size_t lengthOf(unsigned char first) {
    if (first < 0x80U) {
        return first == 0 ? 0 : 1;
    }
    if (first >= 0xC2U && first <= 0xDFU) {
        return 2;
    }
    if (first >= 0xE0U && first <= 0xEFU) {
        return 3;
    }
    return first >= 0xF0U && first <= 0xF4U ? 4 : 0;
}

/// Whether the second byte keeps the sequence from being overlong, a surrogate or too large.
bool fits(unsigned char first, unsigned char second) {
    switch (first) {
        case 0xE0U:
            return second >= 0xA0U;
        case 0xEDU:
            return second < 0xA0U;
        case 0xF0U:
            return second >= 0x90U;
        case 0xF4U:
            return second < 0x90U;
        default:
            return true;
    }
}

/// Length of the well-formed sequence at the beginning; 0: there is none.
std::size_t sequenceAt(std::string_view text) {
    const auto first = static_cast<unsigned char>(text.front());
    const auto length = lengthOf(first);
    if (length < 2 || length > text.size()) {
        return length > text.size() ? 0 : length;
    }
    for (std::size_t i = 1; i < length; ++i) {
        if (!isContinuation(text[i])) {
            return 0;
        }
    }
    return fits(first, static_cast<unsigned char>(text[1])) ? length : 0;
}

/// How many characters at the beginning are ASCII and not NUL, in steps of eight.
std::size_t lengthOfPlain(std::string_view text) {
    std::size_t length = 0;
    for (std::uint64_t eight = 0; length + sizeof eight <= text.size(); length += sizeof eight) {
        std::memcpy(&eight, text.data() + length, sizeof eight);
        // A byte of 0 borrows from its high bit.
        if ((((eight - kOnes) | eight) & kHighBits) != 0) {
            break;
        }
    }
    return length;
}

}  // namespace

bool isStorable(std::string_view text, std::size_t longest) {
    if (text.size() > longest) {
        return false;
    }
    text.remove_prefix(lengthOfPlain(text));
    while (!text.empty()) {
        const auto length = sequenceAt(text);
        if (length == 0) {
            return false;
        }
        text.remove_prefix(length);
    }
    return true;
}

std::string storable(std::string_view text, std::size_t longest) {
    std::string result;
    result.reserve(text.size());
    while (!text.empty()) {
        const auto length = sequenceAt(text);
        const auto piece = length == 0 ? kReplacement : text.substr(0, length);
        if (result.size() + piece.size() > longest) {
            break;
        }
        result += piece;
        text.remove_prefix(length == 0 ? 1 : length);
    }
    return result;
}

}  // namespace metier::records
