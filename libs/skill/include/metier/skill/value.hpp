#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "metier/base/quantities.hpp"

namespace metier::skill {

using metier::Frame;
using metier::Range;
using metier::Vector3;

/// Value of a parameter or a result. monostate is Null: not set.
using Value = std::variant<std::monostate, bool, std::int32_t, std::uint32_t, std::uint64_t, double,
                           std::string, Frame, Vector3, std::vector<double>,
                           std::vector<std::string>, std::vector<Range>, std::vector<Frame>>;

/// The alternatives of Value, in its order.
enum class ValueType : std::uint8_t {
    null,
    boolean,
    int32,
    uint32,
    uint64,
    number,
    text,
    frame,
    vector3,
    numbers,
    texts,
    ranges,
    frames,
};

/// Values by name.
using ValueMap = std::map<std::string, Value, std::less<>>;

inline ValueType typeOf(const Value& value) noexcept {
    return static_cast<ValueType>(value.index());
}

inline bool isNull(const Value& value) noexcept {
    return std::holds_alternative<std::monostate>(value);
}

/// Name of the enumerator, for messages.
std::string_view toString(ValueType type) noexcept;

/// Text for a person: numbers in shortest form, lists in brackets, texts in quotes.
std::string toString(const Value& value);

}  // namespace metier::skill
