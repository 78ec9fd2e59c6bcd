#include "value_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "metier/base/text.hpp"

namespace metier::app {
namespace {

using skill::Value;
using skill::ValueType;

/// A number with blanks before it, as people write lists.
template <typename T>
std::optional<T> numberIn(std::string_view text) {
    return metier::numberIn<T>(text.substr(std::min(text.find_first_not_of(' '), text.size())));
}

/// The parts of a list, each read by `read`; nothing if one cannot be read.
template <typename T>
std::optional<std::vector<T>> listIn(std::string_view text, char separator,
                                     std::optional<T> (*read)(std::string_view)) {
    std::vector<T> values;
    for (const auto part : split(text, separator)) {
        const auto value = read(part);
        if (!value) {
            return std::nullopt;
        }
        values.push_back(*value);
    }
    return values;
}

std::optional<std::vector<double>> numbersIn(std::string_view text) {
    return listIn(text, ',', &numberIn<double>);
}

std::optional<skill::Frame> frameIn(std::string_view text) {
    const auto values = numbersIn(text);
    if (!values || values->size() != 6) {
        return std::nullopt;
    }
    const auto& v = *values;
    return skill::Frame{v[0], v[1], v[2], v[3], v[4], v[5]};
}

std::optional<skill::Vector3> vectorIn(std::string_view text) {
    const auto values = numbersIn(text);
    if (!values || values->size() != 3) {
        return std::nullopt;
    }
    return skill::Vector3{(*values)[0], (*values)[1], (*values)[2]};
}

std::optional<skill::Range> rangeIn(std::string_view text) {
    const auto ends = split(text, ':');
    const auto low = ends.size() == 2 ? numberIn<double>(ends[0]) : std::nullopt;
    const auto high = ends.size() == 2 ? numberIn<double>(ends[1]) : std::nullopt;
    return low && high ? std::optional(skill::Range{*low, *high}) : std::nullopt;
}

std::optional<Value> booleanIn(std::string_view text) {
    if (text == "true" || text == "false") {
        return text == "true";
    }
    return std::nullopt;
}

std::optional<std::string> textIn(std::string_view text) {
    return std::string(text);
}

template <typename T>
std::optional<Value> asValue(const std::optional<T>& value) {
    return value ? std::optional<Value>(Value(*value)) : std::nullopt;
}

std::optional<Value> valueIn(ValueType type, std::string_view text) {
    switch (type) {
        case ValueType::null:
            return std::nullopt;
        case ValueType::boolean:
            return booleanIn(text);
        case ValueType::int32:
            return asValue(numberIn<std::int32_t>(text));
        case ValueType::uint32:
            return asValue(numberIn<std::uint32_t>(text));
        case ValueType::uint64:
            return asValue(numberIn<std::uint64_t>(text));
        case ValueType::number:
            return asValue(numberIn<double>(text));
        case ValueType::text:
            return Value(std::string(text));
        case ValueType::frame:
            return asValue(frameIn(text));
        case ValueType::vector3:
            return asValue(vectorIn(text));
        case ValueType::numbers:
            return asValue(numbersIn(text));
        case ValueType::texts:
            return asValue(listIn(text, ',', &textIn));
        case ValueType::ranges:
            return asValue(listIn(text, ',', &rangeIn));
        case ValueType::frames:
            return asValue(listIn(text, ';', &frameIn));
    }
    return std::nullopt;
}

}  // namespace

Result<Value> parseValue(ValueType type, std::string_view text) {
    if (text == "null") {
        return Value{};
    }
    if (auto value = valueIn(type, text)) {
        return std::move(*value);
    }
    return fail(Errc::invalid_argument,
                fmt::format("'{}' is not written as {}", text, notation(type)));
}

std::string_view notation(ValueType type) noexcept {
    switch (type) {
        case ValueType::null:
            return "null";
        case ValueType::boolean:
            return "true|false";
        case ValueType::int32:
            return "whole number";
        case ValueType::uint32:
        case ValueType::uint64:
            return "whole number, not negative";
        case ValueType::number:
            return "number";
        case ValueType::text:
            return "text";
        case ValueType::frame:
            return "x,y,z,a,b,c";
        case ValueType::vector3:
            return "x,y,z";
        case ValueType::numbers:
            return "number,number,...";
        case ValueType::texts:
            return "text,text,...";
        case ValueType::ranges:
            return "low:high,low:high,...";
        case ValueType::frames:
            return "x,y,z,a,b,c;x,y,z,a,b,c;...";
    }
    return "";
}

}  // namespace metier::app
