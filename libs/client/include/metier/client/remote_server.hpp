#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/composition/used_skill.hpp"
#include "metier/opcua/security.hpp"
#include "metier/skill/executor.hpp"
#include "metier/client/async_skill.hpp"
#include "metier/client/skill_finder.hpp"

namespace metier::client {

struct RemoteServerOptions {
    std::string url;   ///< "opc.tcp://host:port"
    std::string name;  ///< for texts; empty: the URL
    std::string application_name = "metier composition";
    /// Silence after which the server takes this client for gone, and does with what runs as it was
    /// told with its start; at least 2 s.
    std::chrono::milliseconds session_timeout{5'000};
    std::chrono::milliseconds retry_interval{500};  ///< between attempts to connect again
    std::optional<opcua::Credentials> security{};   ///< as opcua::ClientOptions::security
    /// ApplicationUri of the component, which the executions that it starts are told; may be empty.
    std::string own_server{};
};

struct OpenSkill;
class UsedSkillLink;

/// A skill that was opened and has no used skill yet.
struct PendingUse {
    std::shared_ptr<UsedSkillLink> link;   // shared with what is on its way to the used skill
    std::shared_ptr<OpenSkill> skill;  // shared with the work that waits for the server
    client::AsyncSkill::Now now;
    std::string name;
    std::string origin;
};

/// Another server whose skills a component uses. After a loss it connects again by itself.
///
/// What runs when the connection is lost has ended for its user; what still runs of it when the
/// connection is back, or when the component was started again, is halted: nobody waits for it.
/// Threading: connect(), skills(), use() and the destructor wait, on any thread but the
/// executor's; a thread of its own connects again.
class RemoteServer {
public:
    /// \param executor the thread that owns the used_skills
    /// Errors: connection_lost, timeout, access_denied, with the address.
    static Result<std::unique_ptr<RemoteServer>> connect(RemoteServerOptions options,
                                                         std::shared_ptr<skill::Executor> executor);
    /// After its used_skills.
    ~RemoteServer();

    const std::string& url() const noexcept;
    const std::string& name() const noexcept;
    /// Since when there is no connection with all used skills; nothing while there is one. Any
    /// thread.
    std::optional<SteadyTime> awaySince() const;

    /// For further questions before the first use().
    opcua::Client& client();
    /// Every skill there is.
    Result<std::vector<client::SkillAddress>> skills();
    /// \param origin as the executions begin that the used skill's user starts, up to a '~' or '/':
    ///               "pick.PickPlaceSkill"
    /// \return a used skill, for the executor's thread; must end before this
    /// Errors: not_supported, if it lacks StartWith or GetExecution; the server's.
    Result<std::unique_ptr<composition::UsedSkill>> use(const client::SkillAddress& skill,
                                                    std::string origin);

    /// The same in two parts, for an executor that is at work: open() waits, on any thread but the
    /// executor's; used() does not, on the executor's thread and nowhere else.
    Result<PendingUse> open(const client::SkillAddress& skill, std::string origin);
    std::unique_ptr<composition::UsedSkill> used(PendingUse use);

private:
    class Worker;
    explicit RemoteServer(std::unique_ptr<Worker> worker);
    std::unique_ptr<Worker> worker_;
};

}  // namespace metier::client
