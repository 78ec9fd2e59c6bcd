#include "metier/server/property_wish.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "metier/base/overloaded.hpp"
#include "metier/base/text.hpp"

namespace metier::server {
namespace {

using Relation = PropertyWish::Relation;
using PropertyValue = std::variant<bool, double, std::string>;

struct Sign {
    std::string_view text;
    Relation relation;
};

// The longer ones first.
constexpr std::array kSigns{Sign{">=", Relation::at_least}, Sign{"<=", Relation::at_most},
                            Sign{"=", Relation::equal}};

std::string_view signOf(Relation relation) {
    const auto* const found = std::find_if(
        kSigns.begin(), kSigns.end(), [&](const Sign& sign) { return sign.relation == relation; });
    return found == kSigns.end() ? "" : found->text;
}

PropertyValue valueIn(std::string_view text) {
    if (text == "true" || text == "false") {
        return text == "true";
    }
    if (const auto number = numberIn<double>(text)) {
        return *number;
    }
    return std::string(text);
}

std::string shown(const PropertyValue& value) {
    return std::visit(overloaded{[](const std::string& text) { return text; },
                                 [](const auto& plain) { return fmt::format("{}", plain); }},
                      value);
}

bool meets(const PropertyWish& wish, const PropertyValue& value) {
    const auto* number = std::get_if<double>(&value);
    const auto* wished = std::get_if<double>(&wish.value);
    switch (wish.relation) {
        case Relation::exists:
            return true;
        case Relation::equal:
            return value == wish.value;
        case Relation::at_least:
            return number != nullptr && wished != nullptr && *number >= *wished;
        default:
            return number != nullptr && wished != nullptr && *number <= *wished;
    }
}

}  // namespace

Result<PropertyWish> parsePropertyWish(std::string_view text) {
    PropertyWish wish;
    for (const auto& sign : kSigns) {
        const auto at = text.find(sign.text);
        if (at == std::string_view::npos) {
            continue;
        }
        wish.name = trimmed(text.substr(0, at));
        wish.relation = sign.relation;
        wish.value = valueIn(trimmed(text.substr(at + sign.text.size())));
        const bool needs_number = sign.relation != Relation::equal;
        if (wish.name.empty() || (needs_number && !std::holds_alternative<double>(wish.value))) {
            return fail(
                Errc::invalid_argument,
                fmt::format("\"{}\" is not NAME, NAME=VALUE, NAME>=NUMBER or NAME<=NUMBER", text));
        }
        return wish;
    }
    wish.name = trimmed(text);
    return wish.name.empty()
               ? Result<PropertyWish>(fail(Errc::invalid_argument, "a property needs a name"))
               : wish;
}

Verdict judgeProperties(const std::vector<PropertyWish>& wishes, const SurveyedSkill& skill) {
    Verdict verdict;
    for (const auto& wish : wishes) {
        const auto found =
            std::find_if(skill.properties.begin(), skill.properties.end(),
                         [&](const TypeFact& fact) { return fact.name == wish.name; });
        if (found == skill.properties.end()) {
            verdict.fits = false;
            verdict.reasons.push_back("no " + wish.name);
            continue;
        }
        const bool fits = meets(wish, found->value);
        verdict.fits = verdict.fits && fits;
        auto reason = fmt::format("{} {}{}{}", wish.name, shown(found->value),
                                  found->unit.empty() ? "" : " ", found->unit);
        if (wish.relation != Relation::exists) {
            reason += fmt::format(" {}{} {}", fits ? "" : "not ", signOf(wish.relation),
                                  shown(wish.value));
        }
        verdict.reasons.push_back(std::move(reason));
    }
    return verdict;
}

}  // namespace metier::server
