#pragma once

#include <memory>
#include <string>
#include <vector>

#include "finding/skill_matching.hpp"
#include "host/skill_host.hpp"
#include "kinds/rebinder.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/client/remote_server.hpp"
#include "metier/composition/definition.hpp"
#include "metier/opcua_skill/skill_controller.hpp"
#include "metier/server/server.hpp"

namespace metier::server {

/// Skills that files declare, made of skills of other servers and of each other.
///
/// Threading: one thread starts and ends it.
class CompositionServer final : public Server {
public:
    /// Starts the server. With `servers = "discover"` it waits up to 20 s until all used skills are
    /// found.
    /// \param composition of `config`
    /// Errors: mistakes in the files; a used skill server that cannot be reached; a used skill that
    /// no server has or, unless discovered, more than one; the port; cancelled (a stop was asked
    /// for while it waited).
    static Result<std::unique_ptr<CompositionServer>> start(
        const cell::ServerConfig& config, const cell::CompositionServer& composition,
        const Context& context);

    ~CompositionServer() override;

    std::string url() const override { return host_->url(); }

private:
    class Roles;
    CompositionServer(const cell::ServerConfig& config, cell::CompositionServer composition,
                      const Identity& identity, std::unique_ptr<SkillHost> host);
    Result<void> connect(const std::vector<cell::UsedServer>& servers);
    Result<void> offer(std::vector<composition::Definition> definitions,
                       const link::StopSignal& stop);
    Result<void> offerOne(const opcua_skill::SkillController& place,
                          composition::Definition definition, const link::StopSignal& stop);

    Result<std::shared_ptr<client::RemoteServer>> connectFound(const DiscoveredServer& found);
    void keepBound();

    const cell::CompositionServer config_;
    const cell::Discovery discovery_;
    const std::string name_;
    const Identity& identity_;
    std::string life_;  // part of the ids of executions
    std::vector<std::unique_ptr<client::RemoteServer>> servers_;
    std::vector<OfferedSkill> offered_;  // of all compositions
    // Those that were found, shared by the skills that use them.
    std::vector<std::shared_ptr<client::RemoteServer>> found_;
    std::vector<SkillBinding> bindings_;
    std::unique_ptr<Rebinder> rebinder_;
    std::unique_ptr<SkillHost> host_;  // ends before the servers that its skills use
};

}  // namespace metier::server
