#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/server/candidate.hpp"
#include "metier/server/skill_survey.hpp"

namespace metier::server {

/// A wish for a property of a skill's type, such as a control frequency of at least 100 Hz.
struct PropertyWish {
    /// Relation of the property's value to the wished one.
    enum class Relation { exists, equal, at_least, at_most };
    /// BrowseName of the property.
    std::string name{};
    /// How the value must be.
    Relation relation = Relation::exists;
    /// Wished value; numbers are in the unit of the property.
    std::variant<bool, double, std::string> value{};
};

/// Parses "NAME", "NAME=VALUE", "NAME>=NUMBER" or "NAME<=NUMBER". A value that is a number, true or
/// false is taken as such.
/// Errors: invalid_argument. Threads: any; pure.
Result<PropertyWish> parsePropertyWish(std::string_view text);

/// Checks the properties of a skill's types. A property that is not there, or of another type, does
/// not fit. Threads: any; pure.
/// \return one reason per wish: "ControlFrequency 125 Hz >= 100"
Verdict judgeProperties(const std::vector<PropertyWish>& wishes, const SurveyedSkill& skill);

}  // namespace metier::server
