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

struct RemoteServerOptions {
    std::string url;   ///< "opc.tcp://host:port"
    std::string name;  ///< name for messages; empty: the URL
    std::string application_name = "metier composition";
    /// Silence after which the server drops this client's session, and does what OnOwnerLoss says
    /// with its executions; at least 2 s.
    std::chrono::milliseconds session_timeout{5'000};
    std::chrono::milliseconds retry_interval{500};  ///< between attempts to connect again
    std::optional<opcua::Credentials> security{};   ///< as opcua::ClientOptions::security
    /// ApplicationUri of the component; it is sent with each start, for records. May be empty.
    std::string own_server{};
};

class Connection;
struct OpenSkill;
class UsedSkillLink;

/// A skill that was opened and has no used skill yet; moved from open() to usedSkill().
struct PendingUse {
    std::shared_ptr<UsedSkillLink> link;  // shared with what is on its way to the used skill
    std::shared_ptr<OpenSkill> skill;     // shared with the work that waits for the server
    client::AsyncSkill::Now now;
    std::string name;
    std::string origin;
};

/// Another server whose skills a component uses. After a loss of the connection it connects again
/// by itself.
///
/// An execution under way when the connection is lost counts as lost for its user. If it still runs
/// when the connection is back, or when the component was restarted, it is halted, since nothing
/// waits for it any more.
/// Threading: connect(), skills(), use() and the destructor wait; call them on any thread but the
/// executor's. A thread of its own connects again.
class RemoteServer {
public:
    /// \param executor runs on the thread that owns the used skills
    /// Errors: connection_lost, timeout, access_denied, with the address.
    static Result<std::unique_ptr<RemoteServer>> connect(RemoteServerOptions options,
                                                         std::shared_ptr<skill::Executor> executor);
    /// Destroy it after its used skills.
    ~RemoteServer();

    const std::string& url() const noexcept;
    const std::string& name() const noexcept;
    /// Time since which a connection with all used skills is missing; nothing while there is one.
    /// Any thread.
    std::optional<SteadyTime> awaySince() const;

    /// Client of this connection, for other requests before the first use().
    opcua::Client& client();
    /// All skills of the server.
    Result<std::vector<client::SkillAddress>> skills();
    /// Opens a skill and makes a used skill for it.
    /// \param origin prefix of the execution ids of the used skill's user, up to a '~' or '/':
    ///               "pick.PickPlaceSkill"
    /// \return a used skill, for the executor's thread; must end before this
    /// Errors: not_supported, if the skill lacks StartWith or GetExecution; those of the server.
    Result<std::unique_ptr<composition::UsedSkill>> use(const client::SkillAddress& skill,
                                                        std::string origin);

    /// use() in two parts, for an executor that is at work: open() waits, on any thread but the
    /// executor's; usedSkill() does not wait and must be called on the executor's thread.
    Result<PendingUse> open(const client::SkillAddress& skill, std::string origin);
    std::unique_ptr<composition::UsedSkill> usedSkill(PendingUse use);

private:
    RemoteServer(std::unique_ptr<Connection> connection, std::shared_ptr<skill::Executor> executor);

    std::unique_ptr<Connection> connection_;
    std::shared_ptr<skill::Executor> executor_;  // shared by what its thread owns
};

}  // namespace metier::client
