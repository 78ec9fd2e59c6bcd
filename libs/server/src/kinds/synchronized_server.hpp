#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/skill_host.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/client/remote_server.hpp"
#include "metier/composition/synchronized_move_skill.hpp"
#include "metier/opcua_skill/used_skills.hpp"
#include "metier/server/server.hpp"

namespace metier::server {

/// SynchronizedMoveSkill over the arms of other servers.
///
/// Threading: one thread starts and ends it.
class SynchronizedServer final : public Server {
public:
    /// \param arms of `config`
    /// Errors: a used skill server that cannot be reached, or has no arm, or several, whose moves
    /// take a
    ///         start time; the port.
    static Result<std::unique_ptr<SynchronizedServer>> start(const cell::ServerConfig& config,
                                                             const cell::SynchronizedServer& arms,
                                                             const Context& context);

    std::string url() const override { return host_->url(); }

private:
    SynchronizedServer(const Identity& identity, std::unique_ptr<SkillHost> host)
        : identity_(identity), host_(std::move(host)) {}
    Result<void> offer(const std::string& name, const cell::SynchronizedServer& config);
    Result<composition::Arm> connect(const cell::UsedServer& used, const std::string& component);
    Result<std::unique_ptr<composition::UsedSkill>> use(client::RemoteServer& server,
                                                        const std::string& type,
                                                        const std::string& component);

    const Identity& identity_;
    std::vector<std::unique_ptr<client::RemoteServer>> servers_;
    std::vector<opcua_skill::RemoteSkill> used_;
    std::unique_ptr<SkillHost> host_;  // ends before the servers that its skill uses
};

}  // namespace metier::server
