#pragma once

#include <map>
#include <memory>
#include <string>

#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/composition/definition.hpp"
#include "metier/composition/force_source.hpp"
#include "metier/composition/used_skill.hpp"
#include "metier/server/identity.hpp"

namespace metier::server {

class SkillHost;

/// The forces of a component, at which its used skills may end.
class Forces {
public:
    /// \param name of the component
    /// \param host must outlive the used skills
    Forces(const std::string& name, SkillHost& host) : name_(name), host_(host) {}

    /// Connects to the servers that measure them; waits.
    /// Errors: those of client::RemoteForce::connect(), with the name of the force.
    Result<void> connect(const cell::CompositionServer& config, const Identity& identity);
    /// Errors: invalid_argument: the component has no force of that name.
    Result<void> check(const composition::Use& use) const;
    /// The used skill, which also ends at the force of `use`, if that names one.
    /// Errors: invalid_argument: the skill has a MaxForce of its own.
    Result<std::unique_ptr<composition::UsedSkill>> limit(
        const composition::Use& use, std::unique_ptr<composition::UsedSkill> used) const;

private:
    const std::string name_;
    SkillHost& host_;
    // Shared with the used skills that they end.
    std::map<std::string, std::shared_ptr<composition::ForceSource>> sources_;
};

}  // namespace metier::server
