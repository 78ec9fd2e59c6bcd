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

// The structured values, from metier/base/quantities.hpp.
using metier::Frame;
using metier::Range;
using metier::Vector3;

/// Value of a parameter or a result; its unit is that of its field. monostate is Null: not set.
///
///     const ValueMap values{{"Force", 20.0}, {"Width", Value{}}};          // Width: its default
///     if (const auto* force = std::get_if<double>(&values.at("Force"))) { use(*force); }
///
/// A whole number is another type than a double: Value(20) is an Int32, which a Double refuses with
/// type_mismatch.
using Value = std::variant<std::monostate, bool, std::int32_t, std::uint32_t, std::uint64_t, double,
                           std::string, Frame, Vector3, std::vector<double>,
                           std::vector<std::string>, std::vector<Range>, std::vector<Frame>>;

/// The alternatives of Value, in its order. The OPC UA types stand behind them.
enum class ValueType : std::uint8_t {
    /// Null Variant.
    null,
    /// Boolean.
    boolean,
    /// Int32.
    int32,
    /// UInt32.
    uint32,
    /// UInt64.
    uint64,
    /// Double.
    number,
    /// String.
    text,
    /// 3DFrame: [m] and [rad], R = Rz(c) * Ry(b) * Rx(a).
    frame,
    /// 3DVector (ThreeDVector, i=18808 of the base model).
    vector3,
    /// Double[].
    numbers,
    /// String[].
    texts,
    /// Range[].
    ranges,
    /// 3DFrame[].
    frames,
};

/// Values by name. A name may be looked up as std::string_view, without a copy.
using ValueMap = std::map<std::string, Value, std::less<>>;

/// Type that a value has now.
/// Threads of the functions here: any; pure.
inline ValueType typeOf(const Value& value) noexcept {
    return static_cast<ValueType>(value.index());
}

/// Whether a value is Null: not set.
inline bool isNull(const Value& value) noexcept {
    return std::holds_alternative<std::monostate>(value);
}

/// Name of the enumerator, for messages; "Null" for null. Valid for ever.
std::string_view toString(ValueType type) noexcept;

/// Text for a person: numbers in shortest form, lists in brackets, texts in quotes.
/// Without the unit, which the value does not know. jsonOf() gives JSON.
std::string toString(const Value& value);

}  // namespace metier::skill
