#pragma once

#include <string_view>

namespace metier::virtual_edo {

/// Whether the bytes are UTF-8 without overlong forms, surrogates and values above U+10FFFF.
bool isUtf8(std::string_view bytes);

}  // namespace metier::virtual_edo
