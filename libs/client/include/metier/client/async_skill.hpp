#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "metier/client/lack.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"
#include "metier/skill/execution_record.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/program_observer.hpp"
#include "metier/skill/skill.hpp"

namespace metier::client {

class DeviceLocks;

/// Makes the locks of devices that the skills of one client share; any thread, does not wait. They
/// must end before their client.
std::shared_ptr<DeviceLocks> makeDeviceLocks(opcua::Client& client);

/// One skill of a server, for an owner that must not wait: requests are sent without waiting, and
/// the client's thread calls back with their outcomes. A program that may wait is simpler with
/// SkillHandle:
///
///     auto skill = AsyncSkill::open(client, address, {.on_transition = noteTransition});
///     skill->startWith({.parameters = values}, [](opcua::Answer<std::string> id) { ... });
///
/// A skill that knows no executions (OPC 10000-10 has none) is started by writes and Start, and
/// what it does then is taken for the execution that was started here. Its transitions carry no id;
/// on_missed follows each, so that its owner asks.
///
/// Only open(), now() and the destructor wait. Each `done` is called once, at the latest at the
/// client's time-out, even after this object has ended; it is not called if the request itself
/// returns an error.
/// Errors of every request, returned: connection_lost; not_supported (the skill lacks the method).
/// Passed to `done`: those of the server, timeout, connection_lost.
/// Threading: requests from any thread. Must end before its Client.
class AsyncSkill {
public:
    /// Callback for the outcome of a request; runs on the client's thread and must not block. May
    /// send the next request.
    template <typename T = void>
    using Done = std::function<void(opcua::Answer<T>)>;
    /// Callback for a transition; runs on the client's thread and must not block.
    using OnTransition = std::function<void(const skill::TransitionEvent&)>;

    /// Callbacks for events of the skill; each may be empty. Called on the client's thread.
    struct Watch {
        /// Each transition of the skill, of any client's execution.
        OnTransition on_transition{};
        /// The skill begins to come to rest; the transition follows at standstill. Not called for
        /// servers that do not publish it.
        std::function<void(const skill::StoppingEvent&)> on_stopping{};
        /// Transitions may have been missed: ask for the present state.
        std::function<void()> on_missed{};
        /// No further event will come, though requests may still be answered.
        /// \param why for a person
        std::function<void(const std::string& why)> on_ended{};
    };

    /// Reads the skill's description and subscribes to its events; waits for the server. The first
    /// event may come before this returns.
    /// \param client must outlive the result
    /// \param locks  shared by the skills of one client, so that two of the same device may run at
    ///               once; null: the skill has its own
    /// Errors: connection_lost, timeout; those of the server.
    static opcua::Answer<AsyncSkill> open(opcua::Client& client, SkillAddress address, Watch watch,
                                          std::shared_ptr<DeviceLocks> locks = nullptr);
    AsyncSkill(AsyncSkill&&) noexcept;
    AsyncSkill& operator=(AsyncSkill&&) noexcept;
    ~AsyncSkill();

    /// Address that it was opened with; valid as long as this.
    const SkillAddress& address() const noexcept;
    /// Description as far as the server publishes it. Which parameters must be given is not
    /// published: none is marked so. The skill counts as suspendable unless the server says
    /// otherwise.
    const skill::SkillDescription& description() const noexcept;

    /// Whether the server itself names executions. If it does not, another client's execution
    /// cannot be distinguished from one that was started here, and the server does not halt it when
    /// this client is lost.
    bool knowsExecutions() const noexcept;

    /// Whether a start locks the skill's device, as SkillHandle::locksDevice().
    bool locksDevice() const noexcept;
    /// What a run cannot have, as SkillHandle::lacks().
    std::vector<Lack> lacks() const;
    /// Gives back the lock that the last start has taken; to be called when its execution is over.
    /// Does not wait. The destructor does the same.
    void unlock() const;

    /// Present state of the skill.
    struct Now {
        /// State by the Id, Number or name of CurrentState.
        skill::State state = skill::State::halted;
        /// Reason of the state, for a person; may be empty.
        std::string reason_text{};
        /// Id of the last execution; empty if the server does not publish it.
        std::string execution_id{};
    };
    /// Reads the present state; waits for the server.
    /// Errors: connection_lost, timeout; type_mismatch, if CurrentState names no state of a
    /// Program;
    ///         those of the server.
    opcua::Answer<Now> now() const;

    /// Sends StartWith, or writes and Start; `done` gets the execution's id. Running has been
    /// committed then. Without StartWith `on_owner_loss` has no effect, and the device is locked
    /// first if it can be.
    /// Errors: also not_supported, for a lease without StartWith; not_found for an unknown
    ///         parameter; locked, with the name of the client that has locked the device.
    opcua::Answer<> startWith(const skill::StartRequest& request, Done<std::string> done) const;
    /// Calls any method but StartWith, such as Suspend; `done` gets no value. A Suspend or Halt is
    /// answered before standstill.
    opcua::Answer<> call(skill::Method method, Done<> done) const;
    /// Sends Check; `done` gets its report. Nothing moves. A composed skill that must ask others
    /// answers with timeout (delivery: answered) first: ask the same again for the report.
    opcua::Answer<> check(const skill::CheckRequest& request, Done<skill::CheckReport> done) const;
    /// Whether the skill runs skills of others, as far as the server publishes it.
    bool runsOthers() const noexcept;
    /// Sends GetExecution, or reads state and results; `done` gets the record, or the server's
    /// not_found. Where only an event says why a skill is Halted, `done` waits for it, at most 200
    /// ms longer.
    opcua::Answer<> execution(const std::string& id, Done<skill::ExecutionRecord> done) const;

private:
    struct Impl;
    explicit AsyncSkill(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace metier::client
