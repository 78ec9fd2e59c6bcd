#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "device_lock.hpp"
#include "metier/client/skill_handle.hpp"
#include "skill_nodes.hpp"
#include "transition_log.hpp"

namespace metier::client {

/// A name for an execution.
std::string newExecutionId();

/// One execution for whose end a call waits.
struct AwaitedExecution {
    TransitionLog::Mark from;         ///< transitions since may concern it
    std::uint64_t boot = 0;           ///< run of the server that was asked to start it
    std::optional<std::string> id{};  ///< none: known only with the transition that starts it
    bool begun = true;                ///< whether it has begun, as far as is known
};

/// Threading: as SkillHandle, but for the log.
struct SkillHandle::Impl {
    opcua::Client& client;
    SkillAddress address;
    std::uint64_t boot = 0;  // run of the server that the nodes are of
    SkillNodes nodes{};
    std::vector<skill::Field> parameters{};
    std::vector<skill::Field> results{};
    // Shared with the subscription's callback, which may run while this object moves.
    std::shared_ptr<TransitionLog> log = std::make_shared<TransitionLog>();
    TransitionWatch watch{};
    // Execution that this handle started or resumed last, until awaitEnd() has returned its end.
    std::optional<AwaitedExecution> own{};
    // Shared with the answers that are on their way.
    std::shared_ptr<LockUse> lock_use{};

    /// Reads what the skill is like.
    opcua::Answer<> readNodes();
    opcua::Answer<> subscribe();
    /// Looks everything up again if the server was started again since.
    opcua::Answer<> refresh();

    /// Explains a refusal by the skill's own reason.
    opcua::Failure refused(opcua::Failure failure, std::string_view what) const;
    /// Failure for a value of the wrong type, which is refused before it is sent. The skill's
    /// ReasonText must not be used for it: it would be of an older refusal.
    /// A value for a field as it is sent. Errors: out_of_range, type_mismatch.
    opcua::Answer<opcua::Value> sent(const FieldNode& node, const skill::Value& value) const;
    opcua::Failure wrongType(opcua::Failure failure, const FieldNode& node,
                             const skill::Value& given) const;
    std::string reasonText() const;
    opcua::Answer<const FieldNode*> parameter(std::string_view name) const;

    opcua::Answer<std::vector<opcua::Value>> callMetier(opcua::NodeId SkillNodes::*method,
                                                        std::string_view name,
                                                        std::vector<opcua::Value> inputs);
    opcua::Answer<skill::ValueMap> readResults() const;
    opcua::Answer<skill::State> state();
    opcua::Answer<skill::ExecutionRecord> execution(const std::string& id);
    /// Method for a skill that takes it.
    /// Errors: not_supported.
    opcua::Answer<opcua::NodeId> methodNode(skill::Method method) const;
    /// startWith() of a skill that has none: writes, then Start.
    /// Errors: also not_supported, for what only StartWith can ask for.
    opcua::Answer<std::string> startByWrites(SkillHandle& handle,
                                             const skill::StartRequest& request);
    opcua::Answer<ProgramNow> look() const;
    /// Takes the lock of the skill's device for one run; waits. Nothing to do without one.
    /// Errors: locked, with the name of the client that holds it; those of the server.
    opcua::Answer<> lock() const;
    /// Gives it back; waits for the answer, and no run depends on it.
    void unlock() const;

    /// Asks to start or resume, which awaitEnd() is then about.
    template <typename Ask>
    auto begin(const Ask& ask) {
        const AwaitedExecution asked{log->mark(), client.boot()};
        auto answer = ask();
        if (answer) {
            own = asked;
        }
        if (answer && watch.polling.poll()) {
            watch.polling.poll()->noteStart();
        }
        return answer;
    }

    // skill_handle_outcome.cpp

    /// execution(), over losses of the connection.
    /// Errors: not_found, or execution_lost if the server was started again since `since_boot` or
    ///         keeps the name alone; those of the last attempt at the deadline.
    opcua::Answer<skill::ExecutionRecord> learn(const std::string& id, std::uint64_t since_boot,
                                                SteadyTime deadline);
    /// Failure for an execution that the server does not know any more, if that means that it is
    /// over.
    std::optional<opcua::Failure> lostExecution(const std::string& id, std::uint64_t since_boot,
                                                const opcua::Failure& answer) const;
    opcua::Answer<skill::ValueMap> awaitOutcome(AwaitedExecution awaited, SteadyTime deadline);
    /// Waits for the next transition that `wanted` accepts.
    /// \return nothing, if it is time to look at the state
    opcua::Answer<std::optional<TransitionLog::Found>> awaitTransition(
        TransitionLog::Mark from, SteadyTime deadline,
        const std::function<bool(const skill::TransitionEvent&)>& wanted);
    /// The end of an execution that the server does not name, found by looking at the state.
    opcua::Answer<skill::TransitionEvent> awaitNamelessEnd(const AwaitedExecution& awaited,
                                                           SteadyTime deadline);
    /// That end, which `now` shows, with what the server's event says of it.
    skill::TransitionEvent namelessEnd(const ProgramNow& now, TransitionLog::Mark from);
    opcua::Answer<skill::ValueMap> outcomeOf(const AwaitedExecution& awaited,
                                             const skill::TransitionEvent& end,
                                             SteadyTime deadline);
    opcua::Answer<skill::ValueMap> outcomeOf(const skill::ExecutionRecord& record) const;
    opcua::Failure unknownOutcome(const std::string& why) const;
    opcua::Failure startedAgain() const;
    /// Whether the connection is back after `failure`; false at the deadline.
    /// Waits until the skill is in a state that `wanted` names, and returns it.
    opcua::Answer<skill::State> awaitState(SkillHandle& handle, SteadyTime deadline,
                                           const std::function<bool(skill::State)>& wanted);
    bool isBackAfter(const opcua::Failure& failure, SteadyTime deadline);
};

}  // namespace metier::client
