#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>

#include "metier/records/members.hpp"

namespace metier::records {

/// Longest JSON or other text that is never searched [byte].
inline constexpr std::size_t kLongestText = 1'000'000;
/// Longest name of which an index has eight together; PostgreSQL takes 2704 byte [byte].
inline constexpr std::size_t kLongestName = 300;
/// Longest id or reason's text, which an index has alone [byte].
inline constexpr std::size_t kLongestKey = 2'000;

/// Makes text fit for both databases: well-formed UTF-8 without NUL. Bytes that do not fit become
/// U+FFFD; text beyond `longest` is cut off.
std::string storable(std::string_view text, std::size_t longest = kLongestText);

/// Replaces a text by what storable() makes of it.
void makeStorable(std::string& text, Form form);

/// Does so with every text of an ExecutionRow, Transition, Intermediate or Outcome.
template <typename Record>
void makeStorable(Record& record) {
    visitMembers(record, [](const Member& member, auto& value) {
        if constexpr (std::is_same_v<decltype(value), std::string&>) {
            makeStorable(value, member.form);
        }
    });
}

}  // namespace metier::records
