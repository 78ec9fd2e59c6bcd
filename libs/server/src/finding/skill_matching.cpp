#include "finding/skill_matching.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

namespace metier::server {
namespace {

std::string describe(const OfferedSkill& skill) {
    const auto controller = skill.address.controllerName();
    const auto& [reach, payload] = skill.arm;
    return fmt::format("{} ({}{}{}{}{})", skill.address.name, skill.server,
                       controller.empty() ? "" : ", ", controller,
                       reach ? fmt::format(", reach {:.3f} m", *reach) : "",
                       payload ? fmt::format(", payload {} kg", *payload) : "");
}

std::string wishesOf(const composition::Use& use) {
    return fmt::format("{}{}{}{}{}", use.server.empty() ? "" : " of server ", use.server,
                       use.controller.empty() ? "" : " of controller ", use.controller,
                       textOf({use.reach, use.payload}));
}

std::string namesOf(const std::vector<OfferedSkill>& skills) {
    std::vector<std::string> names;
    std::transform(skills.begin(), skills.end(), std::back_inserter(names), describe);
    return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

bool isOfType(const client::SkillAddress& skill, const std::string& type) {
    return skill.type_name == type || skill.type_name + "Type" == type ||
           skill.name + "Type" == type;
}

Result<void> checkOwn(const composition::Use& use) {
    if (!use.controller.empty() || use.reach || use.payload) {
        return fail(Errc::invalid_argument,
                    "controller, reach and payload choose among skills of other servers; a server "
                    "has one skill of a type");
    }
    if (!use.force.empty()) {
        return fail(Errc::invalid_argument,
                    "a force ends skills of other servers, used by one of kind composition");
    }
    return {};
}

Result<OfferedSkill> choose(const composition::Use& use, const std::vector<OfferedSkill>& offered,
                            Derived derived) {
    const auto is_very = [&](const OfferedSkill& skill) {
        return isOfType(skill.address, use.type);
    };
    std::vector<OfferedSkill> of_type;
    std::copy_if(offered.begin(), offered.end(), std::back_inserter(of_type),
                 [&](const auto& skill) {
                     return is_very(skill) ||
                            (derived == Derived::taken && skill.address.servesAs(use.type));
                 });
    std::vector<OfferedSkill> fitting;
    std::copy_if(
        of_type.begin(), of_type.end(), std::back_inserter(fitting), [&](const auto& skill) {
            return (use.server.empty() || skill.server == use.server) &&
                   (use.controller.empty() || skill.address.controllerName() == use.controller) &&
                   isAtLeast({use.reach, use.payload}, skill.arm);
        });
    if (std::any_of(fitting.begin(), fitting.end(), is_very)) {
        std::erase_if(fitting, [&](const OfferedSkill& skill) { return !is_very(skill); });
    }
    if (fitting.empty()) {
        return fail(Errc::not_found,
                    fmt::format("no skill of type {}{}; of that type there are: {}", use.type,
                                wishesOf(use), namesOf(of_type)));
    }
    if (fitting.size() > 1) {
        return fail(Errc::invalid_argument,
                    fmt::format("several skills of type {}: {}; choose one by server and "
                                "controller",
                                use.type, namesOf(fitting)));
    }
    return fitting.front();
}

}  // namespace metier::server
