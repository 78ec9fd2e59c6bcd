#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/opcua/client.hpp"
#include "metier/skill/field.hpp"
#include "metier/skill/field_list.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/program_observer.hpp"
#include "metier/skill/state.hpp"
#include "metier/skill/value.hpp"
#include "metier/client/skill_finder.hpp"

namespace metier::client {

/// One skill of a server, as a client commands and watches it.
///
/// It hears of every transition by events, so nothing polls. Errors of every call: what the server
/// said, with the server's own reason (value, limit, unit) where it gives one; connection_lost;
/// timeout; Failure::delivery says whether the request left.
///
/// With a Client that reconnects a handle stays good. Whoever waits for an execution goes on
/// waiting while the connection is away, up to the deadline, and is then told what has become of
/// it by GetExecution. Nothing is ever started or resumed again. After a restart of the server it
/// looks up the skill again, by its name and controller.
///
/// Threading: any thread but the client's own; calls of one handle one at a time. Must end before
/// its Client.
class SkillHandle {
public:
    /// Reads what the skill is like and subscribes to its transitions. `client` must outlive it.
    static opcua::Answer<SkillHandle> open(opcua::Client& client, SkillAddress address);

    SkillHandle(SkillHandle&&) noexcept;
    SkillHandle& operator=(SkillHandle&&) noexcept;
    ~SkillHandle();

    /// Looks the skill up again if the server was started again since; every call does so first.
    /// References got from the handle before may not be used any more.
    /// Errors: not_found, if the server has the skill no more.
    opcua::Answer<> refresh();

    const SkillAddress& address() const noexcept;
    /// Parameters, of ParameterSet and of Options, with unit, range and present value as default.
    const std::vector<skill::Field>& parameters() const noexcept;
    const std::vector<skill::Field>& results() const noexcept;

    /// Writes one parameter; Null asks for its default.
    /// Errors: not_found (unknown name, with the known), and the server's refusal.
    opcua::Answer<> set(std::string_view name, const skill::Value& value);
    /// Writes a live parameter without waiting, with the time it is meant for; for position
    /// streams. `done` runs on the client's thread.
    opcua::Answer<> setAsync(std::string_view name, const skill::Value& value, UtcTime meant_for,
                             std::function<void(opcua::Answer<>)> done);

    opcua::Answer<> start();
    /// Gives all parameters along and starts, in one step. \return the execution's id
    /// Errors: not_supported, if the server's skill lacks StartWith.
    opcua::Answer<std::string> startWith(const skill::StartRequest& request);
    /// Whether the server can start with an id and tell what became of it: startWith() and
    /// execution().
    bool knowsExecutions() const noexcept;
    /// Whether startWith() tells the server on whose behalf it starts.
    bool takesParents() const noexcept;
    /// What startWith() would say now. Errors: not_supported.
    opcua::Answer<skill::CheckReport> check(const skill::ValueMap& parameters);
    /// What became of an execution, also of another session's. Errors: not_found, not_supported.
    opcua::Answer<skill::ExecutionRecord> execution(const std::string& id);
    opcua::Answer<> suspend();
    opcua::Answer<> resume();
    opcua::Answer<> halt();
    /// Asks again for up to 1 s while the device takes its time.
    /// Errors: timeout, if it is not done then: it goes on, and another reset() gives its outcome.
    opcua::Answer<> reset();
    opcua::Answer<> call(skill::Method method);
    /// Whether this session may call the method now.
    opcua::Answer<bool> executable(skill::Method method);

    opcua::Answer<skill::State> state();
    /// FinalResultData of the last execution that finished.
    opcua::Answer<skill::ValueMap> result();
    /// The server's reason for the last refusal to this session, or for the present state.
    std::string reasonText();

    /// Waits until the skill is in the state `wanted`.
    /// Errors: timeout at the deadline; connection_lost.
    opcua::Answer<> awaitState(skill::State wanted, SteadyTime deadline);
    /// Waits until the skill is not Running, as after Suspend or Halt: what it moves stands then.
    /// \return Suspended, Halted, or Ready if it had reached its end before it came to rest
    /// Errors: as awaitState().
    opcua::Answer<skill::State> awaitRest(SteadyTime deadline);
    /// Waits for the end of what this handle started or resumed last, which may have come already;
    /// once that was told, or if it was somebody else's, for the next transition to Ready or
    /// Halted.
    /// \return that transition; of one that was missed, where it led to and why
    /// Errors: as awaitState(); execution_lost, if the server was started again meanwhile.
    opcua::Answer<skill::TransitionEvent> awaitEnd(SteadyTime deadline);

    /// Sets the parameters, starts, and waits for the end of this execution. If Start is refused,
    /// the parameters fall back to their defaults.
    /// At the deadline it halts the skill and reports timeout, or connection_lost with
    /// Delivery::unknown if the Halt did not arrive.
    /// Errors: as above; device_fault, limit_violated, connection_lost or cancelled if it ended in
    /// Halted, with the reason; cancelled if it was given up while suspended; connection_lost with
    /// Delivery::unknown if transitions were missed and the server cannot tell what became of it.
    opcua::Answer<skill::ValueMap> run(const skill::ValueMap& parameters, SteadyTime deadline);
    /// The same by startWith(). The execution gets an id here if it has none, so that its end is
    /// learnt even if the answer to the start, or its transitions, are lost. If that answer was
    /// lost, connection_lost with Delivery::not_sent says that nothing was started.
    /// Errors: also execution_lost, if the server was started again meanwhile: the motion is over.
    opcua::Answer<skill::ValueMap> runWith(const skill::StartRequest& request, SteadyTime deadline);
    /// The same for parameters and results declared as plain structs.
    template <typename Parameters, typename Results>
    opcua::Answer<Results> run(const skill::FieldList<Parameters>& parameter_list,
                               const Parameters& parameters,
                               const skill::FieldList<Results>& result_list, SteadyTime deadline);

    /// Called on the client's thread for each transition from now on; an empty function ends it.
    void onTransition(std::function<void(const skill::TransitionEvent&)> callback);

private:
    struct Impl;
    void takeBack(const skill::ValueMap& parameters, const opcua::Failure& refusal);
    /// Halts the skill if its end was not seen in time.
    opcua::Answer<skill::ValueMap> orHalt(opcua::Answer<skill::ValueMap> outcome);
    explicit SkillHandle(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

template <typename Parameters, typename Results>
opcua::Answer<Results> SkillHandle::run(const skill::FieldList<Parameters>& parameter_list,
                                        const Parameters& parameters,
                                        const skill::FieldList<Results>& result_list,
                                        SteadyTime deadline) {
    METIER_ASSIGN(auto values, run(parameter_list.write(parameters), deadline));
    auto results = result_list.read(values);
    if (!results) {
        return tl::unexpected(opcua::Failure{results.error(), opcua::status::kBadTypeMismatch, {}});
    }
    return std::move(*results);
}

}  // namespace metier::client
