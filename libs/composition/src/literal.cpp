#include "literal.hpp"

#include <fmt/format.h>

#include <array>
#include <type_traits>
#include <utility>

namespace metier::composition {

namespace {

using cell::TomlValue;
using skill::Value;
using skill::ValueType;

constexpr std::size_t kFrameSize = 6;
constexpr std::size_t kVectorSize = 3;
constexpr std::size_t kRangeSize = 2;

/// The values of all items; nothing if one has none.
template <typename T, typename Get>
std::optional<std::vector<T>> eachOf(const std::vector<TomlValue>& items, Get get) {
    std::vector<T> values;
    for (const auto& item : items) {
        auto value = get(item);
        if (!value) {
            return std::nullopt;
        }
        values.push_back(std::move(*value));
    }
    return values;
}

std::optional<std::vector<double>> numbersOf(const TomlValue& value) {
    return value.isList()
               ? eachOf<double>(value.items(), [](const auto& item) { return item.number(); })
               : std::nullopt;
}

std::optional<Literal> listOf(const TomlValue& value) {
    if (auto numbers = numbersOf(value)) {
        return Literal(std::move(*numbers));
    }
    if (auto texts =
            eachOf<std::string>(value.items(), [](const auto& item) { return item.text(); })) {
        return Literal(std::move(*texts));
    }
    if (auto rows = eachOf<std::vector<double>>(value.items(), numbersOf)) {
        return Literal(std::move(*rows));
    }
    return std::nullopt;
}

template <typename T>
std::optional<T> fromNumbers(const std::vector<double>& n) {
    if constexpr (std::is_same_v<T, skill::Frame>) {
        return n.size() == kFrameSize
                   ? std::optional(skill::Frame{n[0], n[1], n[2], n[3], n[4], n[5]})
                   : std::nullopt;
    } else if constexpr (std::is_same_v<T, skill::Vector3>) {
        return n.size() == kVectorSize ? std::optional(skill::Vector3{n[0], n[1], n[2]})
                                       : std::nullopt;
    } else {
        return n.size() == kRangeSize ? std::optional(skill::Range{n[0], n[1]}) : std::nullopt;
    }
}

template <typename T>
std::optional<std::vector<T>> fromRows(const std::vector<std::vector<double>>& rows) {
    std::vector<T> values;
    for (const auto& row : rows) {
        const auto value = fromNumbers<T>(row);
        if (!value) {
            return std::nullopt;
        }
        values.push_back(*value);
    }
    return values;
}

template <typename T>
std::optional<Value> asValue(std::optional<T> value) {
    return value ? std::optional<Value>(std::move(*value)) : std::nullopt;
}

template <typename T>
std::optional<Value> wholeNumber(std::int64_t number) {
    return std::in_range<T>(number) ? std::optional<Value>(static_cast<T>(number)) : std::nullopt;
}

/// Each call makes the value of one kind of constant, if that type can be written so.
struct Maker {
    ValueType type;

    /// Constants that need no conversion.
    template <typename T>
    std::optional<Value> operator()(const T& plain) const {
        return skill::typeOf(Value(plain)) == type ? std::optional<Value>(plain) : std::nullopt;
    }
    std::optional<Value> operator()(std::int64_t number) const {
        switch (type) {
            case ValueType::number:
                return static_cast<double>(number);
            case ValueType::int32:
                return wholeNumber<std::int32_t>(number);
            case ValueType::uint32:
                return wholeNumber<std::uint32_t>(number);
            case ValueType::uint64:
                return wholeNumber<std::uint64_t>(number);
            default:
                return std::nullopt;
        }
    }
    std::optional<Value> operator()(const std::vector<double>& numbers) const {
        switch (type) {
            case ValueType::numbers:
                return numbers;
            case ValueType::frame:
                return asValue(fromNumbers<skill::Frame>(numbers));
            case ValueType::vector3:
                return asValue(fromNumbers<skill::Vector3>(numbers));
            default:
                return numbers.empty() ? emptyList() : std::nullopt;
        }
    }
    std::optional<Value> operator()(const std::vector<std::vector<double>>& rows) const {
        if (type == ValueType::frames) {
            return asValue(fromRows<skill::Frame>(rows));
        }
        return type == ValueType::ranges ? asValue(fromRows<skill::Range>(rows)) : std::nullopt;
    }

private:
    std::optional<Value> emptyList() const {
        switch (type) {
            case ValueType::texts:
                return std::vector<std::string>();
            case ValueType::ranges:
                return std::vector<skill::Range>();
            case ValueType::frames:
                return std::vector<skill::Frame>();
            default:
                return std::nullopt;
        }
    }
};

}  // namespace

std::optional<Literal> literalOf(const TomlValue& value) {
    if (const auto flag = value.flag()) {
        return Literal(*flag);
    }
    if (const auto integer = value.integer()) {
        return Literal(*integer);
    }
    if (const auto number = value.number()) {
        return Literal(*number);
    }
    if (auto text = value.text()) {
        return Literal(std::move(*text));
    }
    return value.isList() ? listOf(value) : std::nullopt;
}

std::string_view howToWrite(ValueType type) noexcept {
    // In the order of ValueType.
    static constexpr std::array kForms{"nothing",
                                       "true or false",
                                       "a whole number",
                                       "a whole number",
                                       "a whole number",
                                       "a number",
                                       "a text",
                                       "a frame: [x, y, z, a, b, c] in m and rad",
                                       "a vector: [x, y, z]",
                                       "a list of numbers",
                                       "a list of texts",
                                       "a list of ranges: [[low, high], ...]",
                                       "a list of frames: [[x, y, z, a, b, c], ...] in m and rad"};
    static_assert(kForms.size() == std::variant_size_v<Value>);
    return kForms[static_cast<std::size_t>(type)];
}

Result<Value> valueOf(const Literal& literal, ValueType type) {
    if (auto value = std::visit(Maker{type}, literal)) {
        return std::move(*value);
    }
    return fail(Errc::type_mismatch, fmt::format("is not {}", howToWrite(type)));
}

}  // namespace metier::composition
