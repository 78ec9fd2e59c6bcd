#pragma once

#include <map>
#include <string>

#include "server_link.hpp"
#include "skill_shown.hpp"

namespace metier::dashboard {

/// Asks a server once what it offers, and fills a link with it.
///
/// Threading: one thread; waits.
class Survey {
public:
    Survey(const LinkContext& context, ServerLink& link) : context_(context), link_(link) {}

    /// Errors: those of the server.
    opcua::Answer<> run();

private:
    opcua::Answer<> add(const client::SkillAddress& address);
    std::string uniqueKey(const client::SkillAddress& address) const;
    /// Key of the control over a skill.
    opcua::Answer<std::string> addController(const client::SkillAddress& address);
    opcua::Answer<bool> leases(const opcua::NodeId& controller);
    /// \param used server that the skill uses; empty: none
    opcua::Answer<MovedArm> armOf(const client::SkillAddress& address, const std::string& used);
    opcua::Answer<MovedArm> addArm(const client::KinematicsNodes& nodes, const std::string& used);
    /// Notes the other servers of the cell whose skills this one uses, and names the first.
    std::string noteUses(const client::SkillAddress& address);
    /// Largest width of the gripper [m]: the published one, else the upper bound of its parameters.
    double stroke();
    void readState(const LinkedSkill& linked);
    void subscribeAlarms();

    const LinkContext& context_;
    ServerLink& link_;
    std::map<opcua::NodeId, MovedArm> arms_by_controller_;
    std::map<opcua::NodeId, MovedArm> arms_by_object_;
};

}  // namespace metier::dashboard
