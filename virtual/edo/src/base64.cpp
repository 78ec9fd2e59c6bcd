#include "base64.hpp"

#include <openssl/evp.h>

namespace metier::virtual_edo {

std::string toBase64(std::span<const std::uint8_t> bytes) {
    std::vector<std::uint8_t> digits((bytes.size() + 2) / 3 * 4 + 1);
    const auto count = EVP_EncodeBlock(digits.data(), bytes.data(), static_cast<int>(bytes.size()));
    return {digits.begin(), digits.begin() + count};
}

std::optional<std::vector<std::uint8_t>> fromBase64(std::string_view text) {
    const std::vector<std::uint8_t> digits(text.begin(), text.end());
    const std::size_t padding = text.ends_with("==") ? 2 : (text.ends_with('=') ? 1 : 0);
    std::vector<std::uint8_t> bytes(text.size() / 4 * 3);
    // It skips blanks at both ends, and takes '=' for a digit.
    const auto count =
        EVP_DecodeBlock(bytes.data(), digits.data(), static_cast<int>(digits.size()));
    if (text.size() % 4 != 0 || count != static_cast<int>(bytes.size()) ||
        text.find('=') < text.size() - padding) {
        return std::nullopt;
    }
    bytes.resize(bytes.size() - padding);
    return bytes;
}

}  // namespace metier::virtual_edo
