#include "value_json.hpp"

#include <variant>
#include <vector>

namespace metier::app {
namespace {

/// One overload for each alternative of Value.
struct ToJson {
    nlohmann::json operator()(std::monostate) const { return nullptr; }
    template <typename T>
    nlohmann::json operator()(const T& value) const {
        return value;
    }
    nlohmann::json operator()(const skill::Frame& f) const {
        return {{"x", f.x}, {"y", f.y}, {"z", f.z}, {"a", f.a}, {"b", f.b}, {"c", f.c}};
    }
    nlohmann::json operator()(const skill::Vector3& v) const {
        return {{"x", v.x}, {"y", v.y}, {"z", v.z}};
    }
    nlohmann::json operator()(const skill::Range& range) const {
        return {{"low", range.low}, {"high", range.high}};
    }
    nlohmann::json operator()(const std::vector<skill::Range>& ranges) const {
        return list(ranges);
    }
    nlohmann::json operator()(const std::vector<skill::Frame>& frames) const {
        return list(frames);
    }

    template <typename T>
    nlohmann::json list(const std::vector<T>& elements) const {
        auto json = nlohmann::json::array();
        for (const auto& element : elements) {
            json.push_back((*this)(element));
        }
        return json;
    }
};

}  // namespace

nlohmann::json toJson(const skill::Value& value) {
    return std::visit(ToJson{}, value);
}

nlohmann::json toJson(const skill::ValueMap& values) {
    auto json = nlohmann::json::object();
    for (const auto& [name, value] : values) {
        json[name] = toJson(value);
    }
    return json;
}

}  // namespace metier::app
