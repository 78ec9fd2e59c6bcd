#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace metier {

// Small operations on text. Threads: any; pure.

/// Characters around a word that trimmed() removes.
inline constexpr std::string_view kBlanks = " \t\r\n\v\f";

/// The text without the blanks at both ends.
std::string_view trimmed(std::string_view text, std::string_view blanks = kBlanks) noexcept;

/// The parts between separators, empty ones too: "a,,b," has four. An empty text has none.
std::vector<std::string_view> split(std::string_view text, char separator);

/// ASCII letters in lower or upper case, all other bytes as they are.
std::string inLowerCase(std::string_view text);
std::string inUpperCase(std::string_view text);

/// The number that the whole text is; none if there is anything else, blanks and '+' included, or
/// if T cannot hold it.
template <typename T>
std::optional<T> numberIn(std::string_view text) noexcept {
    T number{};
    const auto* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    return read.ec == std::errc() && read.ptr == end ? std::optional(number) : std::nullopt;
}

/// A character of a UTF-8 text.
struct Utf8Character {
    std::uint32_t code_point = 0;
    std::size_t size = 0;  ///< [byte]
};

/// The character at the beginning; none if the text is empty, or begins with a sequence that is
/// cut, overlong, a surrogate or above U+10FFFF.
std::optional<Utf8Character> firstCharacter(std::string_view text) noexcept;

/// Whether the text is well-formed UTF-8.
bool isUtf8(std::string_view text) noexcept;

}  // namespace metier
