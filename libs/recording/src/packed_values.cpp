#include "packed_values.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "metier/skill/json.hpp"

namespace metier::recording {
namespace {

using skill::Value;
using skill::ValueMap;

/// What the first byte says the rest is.
enum class Form : char { map = 'm', value = 'v', json = 'j' };

template <typename T>
requires std::is_trivially_copyable_v<T>
void put(const T& value, std::string& out) {
    const auto bytes = std::bit_cast<std::array<char, sizeof value>>(value);
    out.append(bytes.data(), bytes.size());
}
void put(std::string_view text, std::string& out) {
    put(text.size(), out);
    out += text;
}
void put(const std::string& text, std::string& out) {
    put(std::string_view(text), out);
}
template <typename T>
void put(const std::vector<T>& list, std::string& out) {
    put(list.size(), out);
    for (const auto& element : list) {
        put(element, out);
    }
}
void put(const Value& value, std::string& out) {
    put(static_cast<char>(value.index()), out);
    std::visit([&](const auto& one) { put(one, out); }, value);
}

/// Takes what put() has put from the front of `in`.
template <typename T>
requires std::is_trivially_copyable_v<T>
void take(std::string_view& in, T& value) {
    std::memcpy(&value, in.data(), sizeof value);
    in.remove_prefix(sizeof value);
}
void take(std::string_view& in, std::string& text) {
    std::size_t size = 0;
    take(in, size);
    text = in.substr(0, size);
    in.remove_prefix(size);
}
template <typename T>
void take(std::string_view& in, std::vector<T>& list) {
    std::size_t size = 0;
    take(in, size);
    list.resize(size);
    for (auto& element : list) {
        take(in, element);
    }
}

template <std::size_t Index>
Value takeOf(std::string_view& in) {
    std::variant_alternative_t<Index, Value> value{};
    take(in, value);
    return value;
}

Value takeValue(std::string_view& in) {
    char index = 0;
    take(in, index);
    return [&]<std::size_t... I>(std::index_sequence<I...> /*all*/) {
        Value value;
        static_cast<void>(
            ((index == static_cast<char>(I) ? (value = takeOf<I>(in), true) : false) || ...));
        return value;
    }
    (std::make_index_sequence<std::variant_size_v<Value>>{});
}

ValueMap takeMap(std::string_view in) {
    ValueMap values;
    while (!in.empty()) {
        std::string name;
        take(in, name);
        values.emplace_hint(values.end(), std::move(name), takeValue(in));
    }
    return values;
}

}  // namespace

void pack(const ValueMap& values, std::string& packed) {
    packed.assign(1, static_cast<char>(Form::map));
    for (const auto& [name, value] : values) {
        put(name, packed);
        put(value, packed);
    }
}

std::string packed(const Value& value) {
    std::string bytes(1, static_cast<char>(Form::value));
    put(value, bytes);
    return bytes;
}

std::string packedText(std::string_view json) {
    return static_cast<char>(Form::json) + std::string(json);
}

std::string packedJson(std::string_view packed) {
    const auto form = static_cast<Form>(packed.front());
    packed.remove_prefix(1);
    if (form == Form::map) {
        return skill::jsonOf(takeMap(packed));
    }
    return form == Form::value ? skill::jsonOf(takeValue(packed)) : std::string(packed);
}

}  // namespace metier::recording
