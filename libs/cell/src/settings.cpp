#include "metier/cell/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

namespace metier::cell {

Settings::Settings(std::string place, std::map<std::string, Value> values)
    : place_(std::move(place)) {
    values_.insert(std::make_move_iterator(values.begin()), std::make_move_iterator(values.end()));
}

bool Settings::has(std::string_view name) const {
    asked_.emplace(name);
    return values_.find(name) != values_.end();
}

std::vector<std::string> Settings::namesUnder(std::string_view prefix) const {
    const auto start = std::string(prefix) + ".";
    std::vector<std::string> names;
    for (const auto& [name, value] : values_) {
        if (name.starts_with(start)) {
            names.push_back(name.substr(start.size()));
        }
    }
    return names;
}

template <typename T>
const T* Settings::find(std::string_view name, std::string_view kind) const {
    asked_.emplace(name);
    const auto found = values_.find(name);
    if (found == values_.end()) {
        return nullptr;
    }
    const auto* value = std::get_if<T>(&found->second);
    if (value == nullptr) {
        reject(name, fmt::format("is not {}", kind));
    }
    return value;
}

std::string Settings::text(std::string_view name) const {
    if (!has(name)) {
        reject(name, "missing; needs a text");
        return {};
    }
    return textOr(name, {});
}

std::string Settings::textOr(std::string_view name, const std::string& fallback) const {
    const auto* value = find<std::string>(name, "a text");
    return value == nullptr ? fallback : *value;
}

bool Settings::flagOr(std::string_view name, bool fallback) const {
    const auto* value = find<bool>(name, "true or false");
    return value == nullptr ? fallback : *value;
}

double Settings::numberOr(std::string_view name, double fallback, double low, double high) const {
    const auto* value = find<double>(name, "a number");
    if (value == nullptr) {
        return fallback;
    }
    if (!(*value >= low && *value <= high)) {
        reject(name, fmt::format("{} is not within {} to {}", *value, low, high));
        return fallback;
    }
    return *value;
}

std::vector<double> Settings::numbersOr(std::string_view name, std::vector<double> fallback,
                                        std::size_t count) const {
    const auto* value = find<std::vector<double>>(name, "a list of numbers");
    if (value == nullptr) {
        return fallback;
    }
    if (value->size() != count) {
        reject(name, fmt::format("has {} numbers; needs {}", value->size(), count));
        return fallback;
    }
    return *value;
}

void Settings::reject(std::string_view name, std::string_view why) const {
    problems_.push_back(place_.empty() ? fmt::format("{}: {}", name, why)
                                       : fmt::format("{}.{}: {}", place_, name, why));
}

void Settings::set(std::string name, Value value) {
    values_.insert_or_assign(std::move(name), std::move(value));
}

Result<void> Settings::finish() const {
    for (const auto& [name, value] : values_) {
        if (!asked_.contains(name)) {
            reject(name, fmt::format("unknown; known here: {}", fmt::join(asked_, ", ")));
        }
    }
    if (problems_.empty()) {
        return {};
    }
    return fail(Errc::invalid_argument, fmt::format("{}", fmt::join(problems_, "\n")));
}

}  // namespace metier::cell
