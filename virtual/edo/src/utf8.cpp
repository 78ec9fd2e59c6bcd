#include "metier/virtual_edo/utf8.hpp"

#include <cstddef>
#include <cstdint>

namespace metier::virtual_edo {
namespace {

/// Length of the sequence that the byte begins; 0 if it begins none.
std::size_t sequenceLength(std::uint8_t lead) {
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

/// Whether the second byte makes the form neither overlong, a surrogate, nor too large.
bool isLawfulSecond(std::uint8_t lead, std::uint8_t second) {
    switch (lead) {
        case 0xE0:
            return second >= 0xA0;
        case 0xED:
            return second <= 0x9F;
        case 0xF0:
            return second >= 0x90;
        case 0xF4:
            return second <= 0x8F;
        default:
            return true;
    }
}

}  // namespace

bool isUtf8(std::string_view bytes) {
    const auto at = [&](std::size_t index) { return static_cast<std::uint8_t>(bytes[index]); };
    for (std::size_t i = 0; i < bytes.size();) {
        const std::size_t length = sequenceLength(at(i));
        if (length == 0 || bytes.size() - i < length ||
            (length > 1 && !isLawfulSecond(at(i), at(i + 1)))) {
            return false;
        }
        for (std::size_t next = i + 1; next < i + length; ++next) {
            if ((at(next) & 0xC0U) != 0x80U) {
                return false;
            }
        }
        i += length;
    }
    return true;
}

}  // namespace metier::virtual_edo
