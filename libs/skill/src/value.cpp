#include "metier/skill/value.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <type_traits>

namespace metier::skill {

namespace {

std::string text(std::monostate /*null*/) {
    return "Null";
}
std::string text(const std::string& value) {
    return fmt::format("\"{}\"", value);
}
std::string text(const Range& range) {
    return fmt::format("{}..{}", range.low, range.high);
}
std::string text(const Vector3& v) {
    return fmt::format("({}, {}, {})", v.x, v.y, v.z);
}
std::string text(const Frame& f) {
    return fmt::format("({}, {}, {}, {}, {}, {})", f.x, f.y, f.z, f.a, f.b, f.c);
}

template <typename T>
requires std::is_arithmetic_v<T> std::string text(T value) {
    return fmt::format("{}", value);
}

template <typename T>
std::string text(const std::vector<T>& values) {
    std::vector<std::string> parts;
    parts.reserve(values.size());
    for (const auto& value : values) {
        parts.push_back(text(value));
    }
    return fmt::format("[{}]", fmt::join(parts, ", "));
}

}  // namespace

std::string_view toString(ValueType type) noexcept {
    static constexpr std::array<std::string_view, std::variant_size_v<Value>> names{
        "Null",  "boolean", "int32",   "uint32", "uint64", "number", "text",
        "frame", "vector3", "numbers", "texts",  "ranges", "frames"};
    const auto index = static_cast<std::size_t>(type);
    return index < names.size() ? names[index] : "unknown";
}

std::string toString(const Value& value) {
    return std::visit([](const auto& held) { return text(held); }, value);
}

}  // namespace metier::skill
