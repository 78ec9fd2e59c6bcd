#pragma once

#include <nlohmann/json.hpp>

#include "metier/skill/value.hpp"

namespace metier::app {

/// A value as JSON: frames and vectors as objects, Null as null.
nlohmann::json toJson(const skill::Value& value);
nlohmann::json toJson(const skill::ValueMap& values);

}  // namespace metier::app
