#include "foreign_types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

namespace metier::client {

namespace {

using opcua::NodeId;
using skill::ValueType;

/// Takes a number of a narrower type for one of the wider type that stands for it, and back.
template <typename Narrow, typename Wide>
struct Number {
    static Result<skill::Value> take(const opcua::Value& value) {
        return value.as<Narrow>().map(
            [](Narrow number) { return skill::Value(static_cast<Wide>(number)); });
    }
    static Result<opcua::Value> give(const skill::Value& value) {
        const auto* wide = std::get_if<Wide>(&value);
        if (wide == nullptr) {
            return fail(Errc::type_mismatch, "a number of another type was given");
        }
        if (!fits(*wide)) {
            return fail(Errc::out_of_range, fmt::format("{} is outside {} to {}", *wide,
                                                        std::numeric_limits<Narrow>::lowest(),
                                                        std::numeric_limits<Narrow>::max()));
        }
        return opcua::Value::of(static_cast<Narrow>(*wide));
    }
    static bool fits(Wide wide) {
        if constexpr (std::is_integral_v<Wide>) {
            return std::in_range<Narrow>(wide);
        } else {
            return std::abs(wide) <= std::numeric_limits<Narrow>::max();
        }
    }
};

struct Text {
    static Result<skill::Value> take(const opcua::Value& value) {
        return value.as<opcua::LocalizedText>().map(
            [](const opcua::LocalizedText& text) { return skill::Value(text.text); });
    }
    static Result<opcua::Value> give(const skill::Value& value) {
        const auto* text = std::get_if<std::string>(&value);
        if (text == nullptr) {
            return fail(Errc::type_mismatch, "no text was given");
        }
        return opcua::Value::of(opcua::LocalizedText{"", *text});
    }
};

struct Row {
    std::uint32_t data_type;  // numeric id in namespace 0
    ValueType stand_in;
    Result<skill::Value> (*take)(const opcua::Value& value);
    Result<opcua::Value> (*give)(const skill::Value& value);
};

template <typename Conversion>
constexpr Row row(std::uint32_t data_type, ValueType stand_in) {
    return {data_type, stand_in, Conversion::take, Conversion::give};
}

constexpr std::array kRows{
    row<Number<std::int8_t, std::int32_t>>(2, ValueType::int32),
    row<Number<std::uint8_t, std::int32_t>>(3, ValueType::int32),
    row<Number<std::int16_t, std::int32_t>>(4, ValueType::int32),
    row<Number<std::uint16_t, std::uint32_t>>(5, ValueType::uint32),
    row<Number<float, double>>(10, ValueType::number),
    row<Text>(21, ValueType::text),
};

/// Null if there is none.
const Row* rowOf(const NodeId& data_type) {
    const auto* found = std::find_if(kRows.begin(), kRows.end(), [&](const Row& row) {
        return data_type == NodeId(0, row.data_type);
    });
    return found == kRows.end() ? nullptr : found;
}

}  // namespace

ValueType standInFor(const NodeId& data_type) {
    const auto* row = rowOf(data_type);
    return row == nullptr ? ValueType::null : row->stand_in;
}

Result<skill::Value> fromForeign(const opcua::Value& value, const NodeId& data_type) {
    const auto* row = rowOf(data_type);
    if (value.isEmpty()) {
        return skill::Value();
    }
    return row == nullptr ? fail(Errc::type_mismatch, value.typeName()) : row->take(value);
}

Result<opcua::Value> toForeign(const skill::Value& value, const NodeId& data_type) {
    const auto* row = rowOf(data_type);
    if (std::holds_alternative<std::monostate>(value)) {
        return opcua::Value();
    }
    return row == nullptr ? fail(Errc::type_mismatch, data_type.toString()) : row->give(value);
}

}  // namespace metier::client
