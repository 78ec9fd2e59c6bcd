#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/client/async_skill.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/composition/used_skill.hpp"
#include "metier/opcua/security.hpp"
#include "metier/skill/executor.hpp"

namespace metier::client {

/// Settings of the connection to another server.
struct RemoteServerOptions {
    /// Address: "opc.tcp://host:port".
    std::string url;
    /// Name for messages; empty: the URL.
    std::string name;
    /// Name of this client in the other server's sessions and refusals.
    std::string application_name = "metier composition";
    /// Silence after which the server drops this client's session, and does what OnOwnerLoss says
    /// with its executions; at least 2 s.
    std::chrono::milliseconds session_timeout{5'000};
    /// Pause between attempts to connect again, > 0.
    std::chrono::milliseconds retry_interval{500};
    /// Identity and user, as opcua::ClientOptions::security; none: an open connection.
    std::optional<opcua::Credentials> security{};
    /// ApplicationUri of the component; it is sent with each start, for records. May be empty.
    std::string own_server{};
};

class Connection;
struct OpenSkill;
class UsedSkillLink;

/// A skill that was opened and has no used skill yet; moved from open() to usedSkill(). Its members
/// are for RemoteServer.
struct PendingUse {
    std::shared_ptr<UsedSkillLink> link;  // shared with what is on its way to the used skill
    std::shared_ptr<OpenSkill> skill;     // shared with the work that waits for the server
    client::AsyncSkill::Now now;
    std::string name;
    std::string origin;
};

/// Another server whose skills a component uses. After a loss of the connection it connects again
/// by itself:
///
///     auto server = RemoteServer::connect({.url = "opc.tcp://127.0.0.1:4842"}, executor);
///     auto grasp = (*server)->use(address, "pick.PickPlaceSkill");
///
/// An execution under way when the connection is lost counts as lost for its user. If it still runs
/// when the connection is back, or when the component was restarted, it is halted, since nothing
/// waits for it any more.
/// Threading: connect(), skills(), use() and the destructor wait; call them on any thread but the
/// executor's. A thread of its own connects again.
class RemoteServer {
public:
    /// Connects; waits for the server, once: if it does not answer, the error is returned.
    /// \param executor runs on the thread that owns the used skills
    /// Errors: connection_lost, timeout, access_denied, with the address.
    static Result<std::unique_ptr<RemoteServer>> connect(RemoteServerOptions options,
                                                         std::shared_ptr<skill::Executor> executor);
    /// Ends connection and thread; waits. Destroy it after its used skills.
    ~RemoteServer();

    /// Address as given to connect(); any thread.
    const std::string& url() const noexcept;
    /// Name for messages; any thread.
    const std::string& name() const noexcept;
    /// Time since which a connection with all used skills is missing; nothing while there is one.
    /// Any thread.
    std::optional<SteadyTime> awaySince() const;

    /// Client of this connection, for other requests before the first use(); valid as long as this.
    opcua::Client& client();
    /// Finds all skills of the server, as client::findSkills().
    /// Errors: those of the server, connection_lost, timeout.
    Result<std::vector<client::SkillAddress>> skills();
    /// Opens a skill and makes a used skill for it.
    /// \param origin prefix of the execution ids of the used skill's user, up to a '~' or '/':
    ///               "pick.PickPlaceSkill"
    /// \return a used skill, for the executor's thread; must end before this
    /// Errors: those of the server; not_found, if the skill has no Start or no state.
    Result<std::unique_ptr<composition::UsedSkill>> use(const client::SkillAddress& skill,
                                                        std::string origin);

    /// use() in two parts, for an executor that is at work: open() waits, on any thread but the
    /// executor's; usedSkill() does not wait and must be called on the executor's thread.
    Result<PendingUse> open(const client::SkillAddress& skill, std::string origin);
    /// Second part: makes the used skill; it must end before this. Executor's thread; does not
    /// wait.
    std::unique_ptr<composition::UsedSkill> usedSkill(PendingUse use);

private:
    RemoteServer(std::unique_ptr<Connection> connection, std::shared_ptr<skill::Executor> executor);

    std::unique_ptr<Connection> connection_;
    std::shared_ptr<skill::Executor> executor_;  // shared by what its thread owns
};

}  // namespace metier::client
