#include "packed_values.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <span>
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
    if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
        const auto bytes = std::as_bytes(std::span(list));
        out.append(static_cast<const char*>(static_cast<const void*>(bytes.data())), bytes.size());
    } else {
        for (const auto& element : list) {
            put(element, out);
        }
    }
}
void put(const Value& value, std::string& out) {
    put(static_cast<char>(value.index()), out);
    std::visit([&](const auto& one) { put(one, out); }, value);
}

// From the front of `in`, which may hold anything, what put() has put; false if it is not there.

template <typename T>
requires std::is_trivially_copyable_v<T>
bool take(std::string_view& in, T& value) {
    if (in.size() < sizeof value) {
        return false;
    }
    std::memcpy(&value, in.data(), sizeof value);
    in.remove_prefix(sizeof value);
    return true;
}
bool take(std::string_view& in, bool& value) {
    char byte = 0;
    const bool taken = take(in, byte);
    value = byte != 0;
    return taken;
}
bool take(std::string_view& in, std::string& text) {
    std::size_t size = 0;
    if (!take(in, size) || size > in.size()) {
        return false;
    }
    text = in.substr(0, size);
    in.remove_prefix(size);
    return true;
}
template <typename T>
bool take(std::string_view& in, std::vector<T>& list) {
    std::size_t size = 0;
    if (!take(in, size) || size > in.size()) {  // an element takes a byte at least
        return false;
    }
    list.resize(size);
    return std::all_of(list.begin(), list.end(), [&in](T& element) { return take(in, element); });
}

template <std::size_t Index>
bool takeOf(std::string_view& in, Value& value) {
    return take(in, value.emplace<Index>());
}

bool take(std::string_view& in, Value& value) {
    char index = 0;
    return take(in, index)&& [&]<std::size_t... I>(std::index_sequence<I...> /*all*/) {
        return ((index == static_cast<char>(I) && takeOf<I>(in, value)) || ...);
    }
    (std::make_index_sequence<std::variant_size_v<Value>>{});
}

bool take(std::string_view& in, ValueMap& values) {
    while (!in.empty()) {
        std::string name;
        Value value;
        if (!take(in, name) || !take(in, value)) {
            return false;
        }
        values.insert_or_assign(values.end(), std::move(name), std::move(value));
    }
    return true;
}

template <typename T>
std::string jsonOfPacked(std::string_view in) {
    T value{};
    return take(in, value) ? skill::jsonOf(value) : "null";
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
    const auto form = packed.empty() ? Form::json : static_cast<Form>(packed.front());
    switch (form) {
        case Form::map:
            return jsonOfPacked<ValueMap>(packed.substr(1));
        case Form::value:
            return jsonOfPacked<Value>(packed.substr(1));
        case Form::json:
            return std::string(packed.substr(packed.empty() ? 0 : 1));
    }
    return "null";
}

}  // namespace metier::recording
