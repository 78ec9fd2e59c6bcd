#include "metier/skill/values.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

namespace metier::skill {
namespace {

using nlohmann::json;
using skill::Value;
using skill::ValueType;

// Each gives nothing if the JSON is of another kind, or not finite.

std::optional<double> numberIn(const json& value) {
    if (!value.is_number()) {
        return std::nullopt;
    }
    const auto number = value.get<double>();
    return std::isfinite(number) ? std::optional(number) : std::nullopt;
}

template <typename T>
std::optional<T> wholeIn(const json& value) {
    constexpr double kExact =
        9007199254740992.0;  // beyond, a double is no longer every whole number
    if (value.is_number_unsigned()) {
        const auto whole = value.get<std::uint64_t>();
        return std::in_range<T>(whole) ? std::optional(static_cast<T>(whole)) : std::nullopt;
    }
    if (value.is_number_integer()) {
        const auto whole = value.get<std::int64_t>();
        return std::in_range<T>(whole) ? std::optional(static_cast<T>(whole)) : std::nullopt;
    }
    const auto number = numberIn(value);
    if (!number || std::trunc(*number) != *number || std::abs(*number) > kExact) {
        return std::nullopt;
    }
    const auto whole = static_cast<std::int64_t>(*number);
    return std::in_range<T>(whole) ? std::optional(static_cast<T>(whole)) : std::nullopt;
}

/// Numbers by name in an object that has exactly these, or as a list in this order.
template <std::size_t Count>
std::optional<std::array<double, Count>> numbersIn(const json& value,
                                                   const std::array<const char*, Count>& names) {
    std::array<double, Count> numbers{};
    if (!(value.is_object() || value.is_array()) || value.size() != Count) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < Count; ++i) {
        if (value.is_object() && !value.contains(names[i])) {
            return std::nullopt;
        }
        const auto number = numberIn(value.is_array() ? value[i] : value.at(names[i]));
        if (!number) {
            return std::nullopt;
        }
        numbers[i] = *number;
    }
    return numbers;
}

std::optional<skill::Frame> frameIn(const json& value) {
    const auto n = numbersIn<6>(value, {"x", "y", "z", "a", "b", "c"});
    return n ? std::optional(skill::Frame{(*n)[0], (*n)[1], (*n)[2], (*n)[3], (*n)[4], (*n)[5]})
             : std::nullopt;
}

std::optional<skill::Vector3> vectorIn(const json& value) {
    const auto n = numbersIn<3>(value, {"x", "y", "z"});
    return n ? std::optional(skill::Vector3{(*n)[0], (*n)[1], (*n)[2]}) : std::nullopt;
}

std::optional<skill::Range> rangeIn(const json& value) {
    const auto n = numbersIn<2>(value, {"low", "high"});
    return n ? std::optional(skill::Range{(*n)[0], (*n)[1]}) : std::nullopt;
}

std::optional<bool> flagIn(const json& value) {
    return value.is_boolean() ? std::optional(value.get<bool>()) : std::nullopt;
}

std::optional<std::string> textIn(const json& value) {
    return value.is_string() ? std::optional(value.get<std::string>()) : std::nullopt;
}

template <typename T>
std::optional<std::vector<T>> listIn(const json& value,
                                     std::optional<T> (*elementIn)(const json&)) {
    if (!value.is_array()) {
        return std::nullopt;
    }
    std::vector<T> elements;
    for (const auto& one : value) {
        auto element = elementIn(one);
        if (!element) {
            return std::nullopt;
        }
        elements.push_back(std::move(*element));
    }
    return elements;
}

template <typename T>
std::optional<Value> asValue(std::optional<T> typed) {
    return typed ? std::optional<Value>(std::move(*typed)) : std::nullopt;
}

std::optional<Value> typedFrom(const json& value, ValueType type) {
    switch (type) {
        case ValueType::null:
            return std::nullopt;
        case ValueType::boolean:
            return asValue(flagIn(value));
        case ValueType::int32:
            return asValue(wholeIn<std::int32_t>(value));
        case ValueType::uint32:
            return asValue(wholeIn<std::uint32_t>(value));
        case ValueType::uint64:
            return asValue(wholeIn<std::uint64_t>(value));
        case ValueType::number:
            return asValue(numberIn(value));
        case ValueType::text:
            return asValue(textIn(value));
        case ValueType::frame:
            return asValue(frameIn(value));
        case ValueType::vector3:
            return asValue(vectorIn(value));
        case ValueType::numbers:
            return asValue(listIn(value, &numberIn));
        case ValueType::texts:
            return asValue(listIn(value, &textIn));
        case ValueType::ranges:
            return asValue(listIn(value, &rangeIn));
        case ValueType::frames:
            return asValue(listIn(value, &frameIn));
    }
    return std::nullopt;
}

/// The given value, cut for a message: it came from a client.
std::string shortText(const json& value) {
    constexpr std::size_t kMost = 60;
    auto text = value.dump(-1, ' ', true, json::error_handler_t::replace);
    if (text.size() > kMost) {
        text.resize(kMost);
        text += "...";
    }
    return text;
}

}  // namespace

Result<Value> valueFrom(const json& json_value, ValueType type, std::string_view name) {
    if (json_value.is_null()) {
        return Value{};
    }
    if (auto value = typedFrom(json_value, type)) {
        return std::move(*value);
    }
    return fail(Errc::type_mismatch, fmt::format("{}: {} expected, {} given", name,
                                                 skill::toString(type), shortText(json_value)));
}

}  // namespace metier::skill
