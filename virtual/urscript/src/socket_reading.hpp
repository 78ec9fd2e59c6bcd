#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "metier/urscript/value.hpp"

namespace metier::urscript {

/// Value found in the received bytes of a socket, and the number of bytes that it took.
struct Extracted {
    Value value;
    std::size_t used = 0;
};

// Results of a script's reads from received bytes; empty: more bytes are needed. Pure.
// Source: script manual, module interfaces.

/// `count` integers of `width` bytes each (1 or 4, big-endian), led by their count.
std::optional<Extracted> extractIntegers(std::string_view bytes, std::size_t count,
                                         std::size_t width);
/// Reads `( 1.5, 2 )` as [2, 1.5, 2]; brackets with anything but `count` numbers are a failure.
std::optional<Extracted> extractFloats(std::string_view bytes, std::size_t count);
/// Up to the line feed, which is taken too, without it and a carriage return.
std::optional<Extracted> extractLine(std::string_view bytes);
/// Text between `prefix` and `suffix`. Without a suffix: all received text, if there is any.
std::optional<Extracted> extractText(std::string_view bytes, std::string_view prefix,
                                     std::string_view suffix);
/// The number of a line "name number"; 0 if the line is another one.
std::optional<Extracted> extractVariable(std::string_view bytes, std::string_view name);

/// Result of a failed read: [0, element, element, ...].
Value failedRead(std::size_t count, const Value& element);

/// `\n`, `\r` and `\t`, as they are written, become the characters they mean.
std::string unescaped(std::string_view text);

}  // namespace metier::urscript
