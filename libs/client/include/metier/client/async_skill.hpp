#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "metier/opcua/client.hpp"
#include "metier/skill/execution_record.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/program_observer.hpp"
#include "metier/skill/skill.hpp"
#include "metier/client/skill_finder.hpp"

namespace metier::client {

/// One skill of a server for an owner that must not wait: requests are sent, and their outcomes
/// told, on the client's thread.
///
/// open() and the destructor wait, nothing else does. Each `done` is called once, at the latest at
/// the client's time-out, also after this has ended; not at all if the request is refused here.
/// Errors of every request: connection_lost; not_supported (the skill lacks the method); told:
/// those of the server, timeout, connection_lost.
/// Threading: requests from any thread. Must end before its Client.
class AsyncSkill {
public:
    template <typename T = void>
    using Done = std::function<void(opcua::Answer<T>)>;
    using OnTransition = std::function<void(const skill::TransitionEvent&)>;

    /// Callbacks for what the skill does; each may be empty. On the client's thread.
    struct Watch {
        OnTransition on_transition{};
        /// It begins to come to rest; not called by servers that do not say so.
        std::function<void(const skill::StoppingEvent&)> on_stopping{};
        /// Transitions may have been missed: look what has become of it.
        std::function<void()> on_missed{};
        /// No event will come any more, though requests may still be answered.
        /// \param why for a person
        std::function<void(const std::string& why)> on_ended{};
    };

    /// Reads what the skill is like and subscribes to its events; the first may come before this
    /// returns. `client` must outlive it.
    static opcua::Answer<AsyncSkill> open(opcua::Client& client, SkillAddress address, Watch watch);
    AsyncSkill(AsyncSkill&&) noexcept;
    AsyncSkill& operator=(AsyncSkill&&) noexcept;
    ~AsyncSkill();

    const SkillAddress& address() const noexcept;
    /// Which parameters must be given a server does not tell: none. It can be suspended unless the
    /// server says that it cannot.
    const skill::SkillDescription& description() const noexcept;

    /// Whether executions can be named and asked for: startWith() and execution().
    bool knowsExecutions() const noexcept;

    /// What the skill is doing.
    struct Now {
        skill::State state = skill::State::halted;
        std::string reason_text{};
        std::string execution_id{};  ///< the last one; empty if the server does not tell
    };
    /// Waits for the server.
    opcua::Answer<Now> now() const;

    opcua::Answer<> startWith(const skill::StartRequest& request, Done<std::string> done) const;
    /// Any method but StartWith.
    opcua::Answer<> call(skill::Method method, Done<> done) const;
    opcua::Answer<> check(const skill::ValueMap& parameters, Done<skill::CheckReport> done) const;
    opcua::Answer<> execution(const std::string& id, Done<skill::ExecutionRecord> done) const;

private:
    struct Impl;
    explicit AsyncSkill(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace metier::client
