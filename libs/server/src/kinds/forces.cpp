#include "kinds/forces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/skill_host.hpp"
#include "metier/client/remote_force.hpp"
#include "metier/composition/force_limited_skill.hpp"

namespace metier::server {
namespace {

/// Address of a used server; empty for no name.
std::string urlOf(const cell::CompositionServer& config, const std::string& server) {
    const auto found = std::find_if(config.servers.begin(), config.servers.end(),
                                    [&](const auto& used) { return used.name == server; });
    return found == config.servers.end() ? std::string() : found->url;
}

}  // namespace

Result<void> Forces::connect(const cell::CompositionServer& config, const Identity& identity) {
    for (const auto& force : config.forces) {
        auto source = client::RemoteForce::connect({.server_name = force.server,
                                                    .url = urlOf(config, force.server),
                                                    .force = force.variable,
                                                    .torque = force.torque,
                                                    .arm_url = urlOf(config, force.arm),
                                                    .pose = force.pose,
                                                    .application_name = "metier " + name_,
                                                    .security = identity.credentials()},
                                                   host_.skills().executor());
        if (!source) {
            return fail(source.error().code,
                        fmt::format("force \"{}\": {}", force.name, source.error().message));
        }
        sources_.emplace(force.name, std::move(*source));
    }
    return {};
}

Result<void> Forces::check(const composition::Use& use) const {
    if (use.force.empty() || sources_.contains(use.force)) {
        return {};
    }
    return fail(Errc::invalid_argument,
                fmt::format("{} has no [[server.force]] \"{}\"", name_, use.force));
}

Result<std::unique_ptr<composition::UsedSkill>> Forces::limit(
    const composition::Use& use, std::unique_ptr<composition::UsedSkill> used) const {
    const auto source = sources_.find(use.force);
    if (source == sources_.end()) {
        return used;
    }
    if (skill::findField(used->description().parameters, "MaxForce") != nullptr) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} ends at a force by itself", used->name()));
    }
    return composition::limitForce(std::move(used), source->second, host_.skills().executor(),
                                   host_.clock());
}

}  // namespace metier::server
