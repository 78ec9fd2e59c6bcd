#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "metier/urscript/value.hpp"

namespace metier::urscript {

/// What was found in the bytes that a socket received, and how many of them it took.
struct Extracted {
    Value value;
    std::size_t used = 0;
};

// What the reads of a script make of received bytes; empty: more bytes are needed. Pure.
// Source: script manual, module interfaces.

/// `count` integers of `width` bytes each (1 or 4, big-endian), led by their count.
std::optional<Extracted> extractIntegers(std::string_view bytes, std::size_t count,
                                         std::size_t width);
/// `( 1.5, 2 )` as [2, 1.5, 2]; what is within the brackets and is not `count` numbers is a
/// failure.
std::optional<Extracted> extractFloats(std::string_view bytes, std::size_t count);
/// Up to the line feed, which is taken too, without it and a carriage return.
std::optional<Extracted> extractLine(std::string_view bytes);
/// What is between `prefix` and `suffix`. Without a suffix: all there is, if there is any.
std::optional<Extracted> extractText(std::string_view bytes, std::string_view prefix,
                                     std::string_view suffix);
/// The number of a line "name number"; 0 if the line is another one.
std::optional<Extracted> extractVariable(std::string_view bytes, std::string_view name);

/// What a read gives that failed: [0, element, element, ...].
Value failedRead(std::size_t count, const Value& element);

/// `\n`, `\r` and `\t`, as they are written, become the characters they mean.
std::string unescaped(std::string_view text);

}  // namespace metier::urscript
