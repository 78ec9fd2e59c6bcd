#include "skill_shown.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "metier/client/lack.hpp"
#include "metier/skill/json.hpp"

namespace metier::dashboard {
namespace {

using nlohmann::json;
using skill::Field;
using skill::ValueType;

bool isList(ValueType type) {
    return type == ValueType::numbers || type == ValueType::texts || type == ValueType::ranges ||
           type == ValueType::frames;
}

std::string_view roleOf(const Field& field) {
    const std::string_view name = field.name;
    if (field.type == ValueType::frame || field.type == ValueType::frames) {
        return "pose";
    }
    if (field.type == ValueType::numbers && name.find("JointPosition") != std::string_view::npos) {
        return "joints";
    }
    if (name == "MaxVelocity" || name == "SpeedOverride" || name == "Speeds") {
        return "speed";
    }
    return "";
}

/// Number of elements of a list; for joints one per axis; 0: any number.
std::size_t rankOf(const Field& field, std::size_t axes) {
    if (!isList(field.type)) {
        return 0;
    }
    const auto value = skill::toJson(field.default_value);
    if (value.is_array() && !value.empty()) {
        return value.size();
    }
    return roleOf(field) == "joints" ? axes : 0;
}

json fieldsJson(const skill::Fields& fields, const MovedArm& arm) {
    auto list = json::array();
    for (const auto& field : fields) {
        list.push_back(fieldJson(field, arm));
    }
    return list;
}

}  // namespace

json inLists(const json& value) {
    static const std::vector<std::vector<const char*>> kKnown{
        {"x", "y", "z", "a", "b", "c"}, {"x", "y", "z"}, {"low", "high"}};
    auto lists = value;
    for (const auto& names : kKnown) {
        if (value.is_object() && value.size() == names.size() &&
            std::all_of(names.begin(), names.end(),
                        [&](const char* name) { return value.contains(name); })) {
            lists = json::array();
            for (const auto* name : names) {
                lists.push_back(value.at(name));
            }
            return lists;
        }
    }
    for (auto& element : lists) {
        if (element.is_structured()) {
            element = inLists(element);
        }
    }
    return lists;
}

json fieldJson(const Field& field, const MovedArm& arm) {
    json shown{{"name", field.name},
               {"type", skill::toString(field.type)},
               {"rank", rankOf(field, arm.axes)},
               {"unit", field.unit.symbol},
               {"minimum", nullptr},
               {"maximum", nullptr},
               {"default", inLists(skill::toJson(field.default_value))},
               {"description", field.description},
               {"kind", field.place == skill::Place::options ? "option" : "parameter"},
               {"role", roleOf(field)}};
    if (field.range) {
        shown["minimum"] = field.range->low;
        shown["maximum"] = field.range->high;
    }
    if (field.name == "ToolFrame" && !arm.tools.empty()) {
        shown["choices"] = arm.tools;
    }
    return shown;
}

json skillJson(const std::string& key, const std::string& server, const client::AsyncSkill& skill,
               const MovedArm& arm) {
    const auto& address = skill.address();
    const auto& description = skill.description();
    return {{"key", key},
            {"server", server},
            {"name", address.name},
            {"display_name", address.display_name},
            {"type", address.type_name},
            {"controller", address.controllerName()},
            {"arm", arm.key.empty() ? json() : json(arm.key)},
            {"parameters", fieldsJson(description.parameters, arm)},
            {"results", fieldsJson(description.results, arm)},
            {"can",
             {{"check", skill.knowsExecutions()},
              {"suspend", description.suspendable},
              {"start_with", skill.knowsExecutions()}}},
            {"lacks", client::explanationOf(skill.lacks())}};
}

double strokeIn(const json& skills) {
    for (const auto& skill : skills) {
        for (const auto& field : skill.at("parameters")) {
            if (field.at("name").get<std::string>().find("Width") != std::string::npos &&
                field.at("maximum").is_number()) {
                return field.at("maximum").get<double>();
            }
        }
    }
    return 0.0;
}

}  // namespace metier::dashboard
