#include "skill_session.hpp"

#include <fmt/format.h>

#include "metier/opcua/text.hpp"

namespace metier::dashboard {

using client::AsyncSkill;

opcua::Answer<std::shared_ptr<AsyncSkill>> SkillSession::skill(const LinkedSkill& linked) {
    {
        const std::lock_guard lock(mutex_);
        if (const auto known = skills_.find(linked.key); known != skills_.end()) {
            return known->second;
        }
    }
    METIER_ASSIGN(auto opened, AsyncSkill::open(*client_, linked.address, {}));
    auto skill = std::make_shared<AsyncSkill>(std::move(opened));
    const std::lock_guard lock(mutex_);
    return skills_.try_emplace(linked.key, std::move(skill)).first->second;
}

Error explained(const opcua::Failure& failure, const AsyncSkill& skill, std::string_view what) {
    const auto& name = skill.address().name;
    if (failure.delivery != opcua::Failure::Delivery::answered) {
        return {failure.code,
                opcua::sanitise(fmt::format("{} {}: {}", name, what, failure.message))};
    }
    if (failure.status == opcua::status::kBadUserAccessDenied) {
        return {Errc::access_denied,
                fmt::format("{} refused {}: this user may not command", name, what)};
    }
    const auto now = skill.now();
    const auto reason = now ? opcua::sanitise(now->reason_text) : "";
    return {failure.code, fmt::format("{} refused {}: {}", name, what,
                                      reason.empty() ? failure.status.name() : reason)};
}

}  // namespace metier::dashboard
