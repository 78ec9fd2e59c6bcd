#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "await_answer.hpp"
#include "foreign_run.hpp"
#include "metier/client/async_skill.hpp"
#include "metier/opcua/client.hpp"
#include "server_link.hpp"

namespace metier::dashboard {

/// Whether a skill whose server names no executions runs as it was started here.
///
/// Transitions may be reported late, so an end counts only if as many Running were reported before
/// as there were starts. After an end that is not reported it counts as running; reading the
/// skill's state shows that it is not. Threading: any.
class StartedRun {
public:
    /// Begins a start; false if another one is under way, or what was started may still run.
    /// \param at_rest whether the skill was seen at rest just now
    bool begin(bool at_rest);
    /// Ends it. \param started whether it may have begun to run
    void answered(bool started);
    void note(skill::State now);
    bool isOver() const;

private:
    mutable std::mutex mutex_;
    unsigned starts_ = 0;
    unsigned running_ = 0;  // transitions to Running, as many as starts at most
    bool starting_ = false;
    bool over_ = true;
    bool was_over_ = true;  // before the present start
};

/// A session with one server, and the skills that were used by it.
///
/// Threading: any; waits for the server.
class SkillSession {
public:
    /// \param store for what is started by it
    SkillSession(std::unique_ptr<opcua::Client> client, ForeignStore store)
        : client_(std::move(client)), store_(std::move(store)) {}

    opcua::Client& client() noexcept { return *client_; }
    bool isConnected() const noexcept {
        return client_->state() == opcua::Client::State::connected;
    }
    /// The skill, as this session uses it. Errors: the server's.
    opcua::Answer<std::shared_ptr<client::AsyncSkill>> skill(const LinkedSkill& linked);

    /// Starts a skill. Without leases its device is locked, if it can be, until this session ends.
    /// \return id of the execution
    /// Errors: those of AsyncSkill::startWith(); invalid_state, while what was started here runs.
    opcua::Answer<std::string> start(const LinkedSkill& linked, const skill::StartRequest& request);
    /// Halts each skill that was started here, still runs, and whose server would let it go on
    /// without this session. \return what was not halted, for a person
    std::vector<std::string> haltStarted();
    /// Notes that a Halt of a skill is about to be sent from the page.
    void expectHalt(const std::string& key);

private:
    /// A skill as this session uses it.
    struct Used {
        // Shared with the threads that wait for an answer at this moment.
        std::shared_ptr<client::AsyncSkill> skill;
        // Both shared with the callback of its transitions.
        std::shared_ptr<StartedRun> run;
        std::shared_ptr<ForeignRun> record;
    };
    opcua::Answer<Used> use(const LinkedSkill& linked);

    const std::unique_ptr<opcua::Client> client_;  // first: the skills use it
    const ForeignStore store_;
    // Shared by the skills.
    const std::shared_ptr<client::DeviceLocks> locks_ = client::makeDeviceLocks(*client_);
    std::mutex mutex_;
    std::map<std::string, Used> skills_;
};

/// A refusal with the server's own reason, where it gives one.
Error explained(const opcua::Failure& failure, const client::AsyncSkill& skill,
                std::string_view what);

}  // namespace metier::dashboard
