#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "finding/discovered_servers.hpp"
#include "metier/base/clock.hpp"
#include "metier/cell/cell.hpp"
#include "metier/client/remote_server.hpp"
#include "metier/composition/sequence_skill.hpp"
#include "metier/opcua/node_id.hpp"
#include "metier/skill/executor.hpp"

namespace metier::server {

class Forces;
class SkillHost;

/// Uses of one composed skill that one server serves, which was found.
struct SkillBinding {
    std::string skill_name;
    composition::SequenceSkill* skill = nullptr;  ///< used on the executor's thread
    opcua::NodeId node;                           ///< node of the composed skill
    std::string origin;                           ///< as RemoteServer::use() takes it
    std::vector<composition::Use> uses;           ///< they move together
    /// Shared by the bindings to one server.
    std::shared_ptr<client::RemoteServer> server;
    SteadyTime next_try{};
};

/// Gives composed skills other servers where theirs stay away, between two executions.
///
/// The former server is kept until it is back: what still runs there of the skill is halted then.
/// Threading: a thread of its own asks and connects; what it changes it changes on the executor's.
/// stop() waits for it, some seconds, on neither of the two.
class Rebinder {
public:
    struct Setup {
        cell::Discovery discovery;
        const Identity& identity;      ///< identity of the component
        std::string own_url;           ///< address of the component, which it leaves out itself
        std::string application_name;  ///< as others see it
        std::string own_server;        ///< ApplicationUri that executions get as their parent's
        std::chrono::duration<double> rebind_after;  ///< absence of a server [s]
        std::shared_ptr<skill::Executor> executor;   ///< shared by what its thread owns
        SkillHost& host;                             ///< of the component
        const Forces& forces;                        ///< of the component
    };

    Rebinder(Setup setup, std::vector<SkillBinding> bindings);
    /// Stops. After the composed skills, which use its servers.
    ~Rebinder();
    Rebinder(const Rebinder&) = delete;
    Rebinder& operator=(const Rebinder&) = delete;

    /// Ends its work; before the composed skills end. May be called again.
    void stop();

private:
    struct Former;
    struct Exchange;

    void run(const std::stop_token& stop);
    void renew(SkillBinding& binding);
    Result<void> moveTo(const DiscoveredServer& other, SkillBinding& binding);
    Result<void> exchange(Exchange& parts, SkillBinding& binding);
    void show(const Exchange& parts, const SkillBinding& binding);
    void forget();
    Result<void> letGoOf(const Former& former);
    Result<void> onExecutor(std::function<Result<void>()> work);
    void tell(const SkillBinding& binding, const Error& error);

    const Setup setup_;
    std::vector<SkillBinding> bindings_;
    std::vector<Former> formers_;
    std::string reported_;  // the last complaint, which is not repeated
    std::mutex mutex_;      // for the wait
    std::condition_variable_any wake_;
    std::jthread thread_;
};

}  // namespace metier::server
