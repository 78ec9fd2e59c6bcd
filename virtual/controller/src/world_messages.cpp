#include "metier/virtual_controller/world_messages.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

namespace metier::virtual_controller {
namespace {

using Json = nlohmann::json;

std::optional<Json> objectOf(std::string_view line) {
    auto parsed = Json::parse(line, nullptr, false);
    if (!parsed.is_object()) {
        return std::nullopt;
    }
    return parsed;
}

/// Empty unless they are `count` finite numbers.
std::vector<double> numbers(const Json& object, const char* key, std::size_t count) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_array() || found->size() != count) {
        return {};
    }
    std::vector<double> values;
    for (const auto& element : *found) {
        if (!element.is_number() || !std::isfinite(element.get<double>())) {
            return {};
        }
        values.push_back(element.get<double>());
    }
    return values;
}

std::optional<double> number(const Json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number() || !std::isfinite(found->get<double>())) {
        return std::nullopt;
    }
    return found->get<double>();
}

std::optional<motion::Pose> poseOf(const Json& object, const char* key) {
    const auto v = numbers(object, key, 7);
    if (v.empty()) {
        return std::nullopt;
    }
    const Eigen::Quaterniond rotation(v[3], v[4], v[5], v[6]);
    if (!(rotation.norm() >= 0.5 && std::isfinite(rotation.norm()))) {
        return std::nullopt;
    }
    return motion::Pose{{v[0], v[1], v[2]}, rotation.normalized()};
}

Json toJson(const motion::Pose& pose) {
    const auto& t = pose.translation;
    const auto& r = pose.rotation;
    return Json::array({t.x(), t.y(), t.z(), r.w(), r.x(), r.y(), r.z()});
}

}  // namespace

std::string toLine(const NamedReport& report) {
    Json object{
        {"name", report.name}, {"time", report.report.time}, {"gripping", report.report.gripping}};
    if (report.report.base_from_flange) {
        object["flange"] = toJson(*report.report.base_from_flange);
    }
    if (report.report.jaw_width) {
        object["jaws"] = *report.report.jaw_width;
    }
    return object.dump() + '\n';
}

std::string toLine(const WorldEffect& effect) {
    const auto& f = effect.wrench.force;
    const auto& t = effect.wrench.torque;
    Json object{{"wrench", {f.x(), f.y(), f.z(), t.x(), t.y(), t.z()}}};
    if (effect.part_width) {
        object["part"] = *effect.part_width;
    }
    return object.dump() + '\n';
}

std::optional<NamedReport> reportOf(std::string_view line) {
    const auto object = objectOf(line);
    if (!object || !object->contains("name") || !object->at("name").is_string()) {
        return std::nullopt;
    }
    NamedReport report;
    report.name = object->at("name").get<std::string>();
    report.report.time = number(*object, "time").value_or(0.0);
    report.report.base_from_flange = poseOf(*object, "flange");
    report.report.jaw_width = number(*object, "jaws");
    const auto gripping = object->find("gripping");
    report.report.gripping =
        gripping != object->end() && gripping->is_boolean() && gripping->get<bool>();
    return report;
}

std::optional<WorldEffect> effectOf(std::string_view line) {
    const auto object = objectOf(line);
    if (!object) {
        return std::nullopt;
    }
    const auto w = numbers(*object, "wrench", 6);
    if (w.empty()) {
        return std::nullopt;
    }
    WorldEffect effect;
    effect.wrench.force = {w[0], w[1], w[2]};
    effect.wrench.torque = {w[3], w[4], w[5]};
    effect.part_width = number(*object, "part");
    return effect;
}

}  // namespace metier::virtual_controller
