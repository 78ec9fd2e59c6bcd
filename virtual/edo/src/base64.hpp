#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace metier::virtual_edo {

/// Base64 with padding, standard alphabet (RFC 4648 section 4).
std::string toBase64(std::span<const std::uint8_t> bytes);

/// Nothing if `text` is not base64 with padding.
std::optional<std::vector<std::uint8_t>> fromBase64(std::string_view text);

}  // namespace metier::virtual_edo
