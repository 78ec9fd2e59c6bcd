#include "metier/skill/json.hpp"

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <variant>
#include <vector>

namespace metier::skill {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

/// One overload for each alternative of Value. An ordered_json becomes text.
template <typename Json>
struct ToJson {
    Json operator()(std::monostate) const { return nullptr; }
    template <typename T>
    Json operator()(const T& value) const {
        return value;
    }
    Json operator()(double value) const {
        constexpr double kLargestShort = 1e15;
        const bool whole = std::trunc(value) == value && std::abs(value) < kLargestShort;
        return whole && std::is_same_v<Json, ordered_json> ? Json(static_cast<std::int64_t>(value))
                                                           : Json(value);
    }
    Json operator()(const Frame& f) const {
        return members({{"x", f.x}, {"y", f.y}, {"z", f.z}, {"a", f.a}, {"b", f.b}, {"c", f.c}});
    }
    Json operator()(const Vector3& v) const {
        return members({{"x", v.x}, {"y", v.y}, {"z", v.z}});
    }
    Json operator()(const Range& range) const {
        return members({{"low", range.low}, {"high", range.high}});
    }
    template <typename T>
    Json operator()(const std::vector<T>& list) const {
        auto elements = Json::array();
        for (const auto& element : list) {
            elements.push_back((*this)(element));
        }
        return elements;
    }
    Json operator()(const Value& value) const { return std::visit(*this, value); }
    Json operator()(const ValueMap& values) const {
        auto named = Json::object();
        for (const auto& [name, value] : values) {
            named[name] = (*this)(value);
        }
        return named;
    }

    Json members(std::initializer_list<std::pair<const char*, double>> numbers) const {
        auto object = Json::object();
        for (const auto& [name, number] : numbers) {
            object[name] = (*this)(number);
        }
        return object;
    }
};

std::string textOf(const ordered_json& value) {
    return value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace

json toJson(const Value& value) {
    return ToJson<json>()(value);
}

json toJson(const ValueMap& values) {
    return ToJson<json>()(values);
}

std::string jsonOf(const Value& value) {
    return textOf(ToJson<ordered_json>()(value));
}

std::string jsonOf(const ValueMap& values) {
    return textOf(ToJson<ordered_json>()(values));
}

}  // namespace metier::skill
