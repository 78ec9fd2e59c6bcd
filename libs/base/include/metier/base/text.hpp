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

// Small operations on text. Threads: any; pure. Returned views point into the given text.

/// Characters that trimmed() removes unless it is given others.
inline constexpr std::string_view kBlanks = " \t\r\n\v\f";

/// The text without the blanks at both ends; empty if it has nothing else.
/// \param blanks each character of it is removed
std::string_view trimmed(std::string_view text, std::string_view blanks = kBlanks) noexcept;

/// Parts between separators, including empty ones: "a,,b," has four parts. An empty text has none.
/// The parts are not trimmed.
/// \param separator one byte; a multi-byte UTF-8 character cannot be one
///
///     for (const auto part : split("a, b", ',')) { use(trimmed(part)); }  // "a", "b"
std::vector<std::string_view> split(std::string_view text, char separator);

/// The text with ASCII letters in lower case, all other bytes as they are, whatever the locale is.
std::string inLowerCase(std::string_view text);
/// The same in upper case.
std::string inUpperCase(std::string_view text);

/// Number that the whole text spells, decimal if T is an integer. Nothing if the text has any other
/// character (a blank or a leading '+' included), or if T cannot hold the number. "inf" and "nan"
/// are numbers for a floating-point T: check std::isfinite().
///
///     numberIn<std::uint16_t>("4840");   // 4840
///     numberIn<std::uint16_t>("70000");  // nothing: more than 16 bits hold
///     numberIn<double>("1e-3");          // 0.001
template <typename T>
std::optional<T> numberIn(std::string_view text) noexcept {
    T number{};
    const auto* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    return read.ec == std::errc() && read.ptr == end ? std::optional(number) : std::nullopt;
}

/// One character of a UTF-8 text.
struct Utf8Character {
    /// Unicode code point, 0 to 0x10FFFF without surrogates.
    std::uint32_t code_point = 0;
    /// Number of bytes that it takes in the text, 1 to 4.
    std::size_t size = 0;
};

/// First character of the text. Nothing if the text is empty, or begins with a sequence that is
/// cut, overlong, a surrogate or above U+10FFFF.
std::optional<Utf8Character> firstCharacter(std::string_view text) noexcept;

/// Whether the text is well-formed UTF-8; an empty one is.
bool isUtf8(std::string_view text) noexcept;

}  // namespace metier
