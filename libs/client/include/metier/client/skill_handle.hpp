#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/client/lack.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"
#include "metier/skill/field.hpp"
#include "metier/skill/field_list.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/program_observer.hpp"
#include "metier/skill/state.hpp"
#include "metier/skill/value.hpp"

namespace metier::client {

/// One skill of a server, for a client that commands and watches it:
///
///     auto skill = findSkill(client, "JointPtpMoveSkill");
///     auto arm = SkillHandle::open(client, *skill);
///     auto result = arm->run({{"TargetJointPosition", joints}}, steady_clock::now() + 30s);
///
/// Transitions arrive as events. A server that does not name executions is also asked for the state
/// each second, and every 20 ms if it has no subscriptions. Errors of every call: those of the
/// server, with the server's text (value, limit, unit) if it gives one; connection_lost; timeout.
/// Failure::delivery says whether the request left.
///
/// With a Client that reconnects a handle stays usable. A call that waits for the end of an
/// execution goes on while the connection is away, up to the deadline, and then asks for the
/// outcome by GetExecution. Nothing is ever started or resumed a second time. After a restart of
/// the server the skill is looked up again, by its name and controller.
///
/// Threading: any thread but the client's own; calls of one handle one at a time. Each waits for
/// the server, but those that return a reference or say otherwise. Must end before its Client.
class SkillHandle {
public:
    /// Reads the skill's description and subscribes to its transitions.
    /// \param client must outlive the handle
    /// Errors: those of the server, connection_lost, timeout.
    static opcua::Answer<SkillHandle> open(opcua::Client& client, SkillAddress address);

    SkillHandle(SkillHandle&&) noexcept;
    SkillHandle& operator=(SkillHandle&&) noexcept;
    ~SkillHandle();

    /// Looks the skill up again if the server was started again; every call does so first.
    /// References that the handle returned before are not valid any more.
    /// Errors: not_found, if the server does not have the skill any more.
    opcua::Answer<> refresh();

    /// Address of the skill; after a restart of the server the new one. Valid until refresh() finds
    /// one.
    const SkillAddress& address() const noexcept;
    /// Parameters of ParameterSet and of Options, with unit, range and the value at open() or the
    /// last refresh() as default.
    const std::vector<skill::Field>& parameters() const noexcept;
    /// Results of FinalResultData, with unit.
    const std::vector<skill::Field>& results() const noexcept;

    /// Writes one parameter; Null sets it to its default. In Ready this binds the parameters to
    /// this session, until Start or for 10 s.
    /// \param value in the unit of the field; its type must be that of the field
    /// Errors: not_found (unknown name, with the known names); the server's refusal: type_mismatch,
    ///         out_of_range, locked, invalid_state.
    opcua::Answer<> set(std::string_view name, const skill::Value& value);
    /// Writes a live parameter without waiting; for position streams.
    /// \param meant_for time for which the value is meant, by this machine's clock; sent as
    ///                  SourceTimestamp; none: not sent
    /// \param done runs once, on the client's thread; not called if this returns an error
    opcua::Answer<> setAsync(std::string_view name, const skill::Value& value,
                             std::optional<UtcTime> meant_for,
                             std::function<void(opcua::Answer<>)> done);

    /// Calls Start with the parameters that were set. Running has been committed when this returns
    /// without an error.
    opcua::Answer<> start() { return call(skill::Method::start); }
    /// Sets all parameters and starts, in one call. Running has been committed when this returns
    /// without an error. A skill without StartWith is started by writes and Start, with its
    /// device's lock if there is one, see locksDevice(); awaitEnd() gives the lock back.
    /// \return the execution's id; one of this handle alone, if the skill has no StartWith
    /// Errors: not_supported, for a lease or an action on the loss of the owner without StartWith;
    ///         locked, with the name of the client that has locked the device;
    ///         the server's refusal, see skill::Program::startWith().
    opcua::Answer<std::string> startWith(const skill::StartRequest& request);
    /// Whether the server supports named executions: startWith() and execution().
    bool knowsExecutions() const noexcept;
    /// Whether a start of a skill without named executions locks its device (LockingServices of OPC
    /// 10000-100) until the end of the run. Without, another client may write between the
    /// parameters and Start.
    bool locksDevice() const noexcept;
    /// What a run cannot have, since the server is of another maker.
    std::vector<Lack> lacks() const;
    /// Whether startWith() sends the execution on whose behalf it starts: the server keeps records.
    bool takesParents() const noexcept;
    /// Asks whether startWith() would succeed now; nothing moves. Asks repeatedly, for up to 15 s,
    /// while a composed skill asks the skills that it uses.
    /// \param starts places of arms that will stand elsewhere by then; only for servers whose Check
    ///               reports where arms end (CheckReport::ends_known)
    /// Errors: not_supported; timeout.
    opcua::Answer<skill::CheckReport> check(const skill::ValueMap& parameters,
                                            const skill::ArmPositions& starts = {});
    /// Record of an execution, also one of another session.
    /// Errors: not_found, not_supported.
    opcua::Answer<skill::ExecutionRecord> execution(const std::string& id);
    /// Calls Suspend; the answer comes before standstill, see awaitRest().
    opcua::Answer<> suspend() { return call(skill::Method::suspend); }
    /// Calls Resume. Running has been committed when this returns without an error.
    opcua::Answer<> resume() { return call(skill::Method::resume); }
    /// Calls Halt; the answer comes before standstill, see awaitRest(). Allowed also while another
    /// client has control.
    opcua::Answer<> halt() { return call(skill::Method::halt); }
    /// Calls Reset, repeatedly for up to 1 s while the device is not done. Ready has been committed
    /// when this returns without an error.
    /// Errors: timeout, if it is not done then: it goes on, and another reset() returns its
    ///         outcome; device_fault, with the reason.
    opcua::Answer<> reset();
    /// Calls a method without arguments: any but StartWith.
    opcua::Answer<> call(skill::Method method);
    /// Whether this session may call the method now, by its UserExecutable attribute.
    opcua::Answer<bool> executable(skill::Method method);

    /// Present state, read from the server. Errors: type_mismatch, if it is none of the four.
    opcua::Answer<skill::State> state();
    /// FinalResultData of the last execution that finished, of any client; Null for a value that
    /// the server does not have.
    opcua::Answer<skill::ValueMap> result();
    /// Reason of the server's last refusal to this session, or of the present state; empty if the
    /// server does not answer or publish one.
    std::string reasonText();

    /// Waits until the skill is in the state `wanted`, by its transitions.
    /// Errors: timeout at the deadline; connection_lost.
    opcua::Answer<> awaitState(skill::State wanted, SteadyTime deadline);
    /// Waits until the skill is not Running, for example after Suspend or Halt; then its device
    /// stands still.
    /// \return Suspended, Halted, or Ready if it had reached its end before it came to rest
    /// Errors: as awaitState().
    opcua::Answer<skill::State> awaitRest(SteadyTime deadline);
    /// Waits for the end of the execution that this handle started or resumed last; that end may
    /// have come already. If that end was returned before, or the execution belongs to another
    /// client, it waits for the next transition to Ready or Halted.
    /// \return that transition; if it was missed, only its target state and reason are known
    /// Errors: as awaitState(); execution_lost, if the server was started again meanwhile.
    opcua::Answer<skill::TransitionEvent> awaitEnd(SteadyTime deadline);

    /// Sets the parameters, starts, and waits for the end of this execution. If Start is refused,
    /// the parameters are set back to their defaults. At the deadline it halts the skill and
    /// reports timeout, or connection_lost with Delivery::unknown if the Halt did not arrive.
    /// Errors: as above; device_fault, limit_violated, connection_lost or cancelled, with the
    /// reason, if it ended Halted; cancelled if it was given up while suspended; connection_lost
    /// with Delivery::unknown if transitions were missed and the server does not know the outcome.
    opcua::Answer<skill::ValueMap> run(const skill::ValueMap& parameters, SteadyTime deadline);
    /// Does the same by startWith(). An execution without an id gets one here, so that its end is
    /// found even if the answer to the start, or its transitions, are lost. If the answer was lost
    /// and nothing was started, the error is connection_lost with Delivery::not_sent.
    /// Errors: also execution_lost, if the server was started again meanwhile: the motion is over.
    opcua::Answer<skill::ValueMap> runWith(const skill::StartRequest& request, SteadyTime deadline);
    /// Does the same for parameters and results that are declared as plain structs.
    template <typename Parameters, typename Results>
    opcua::Answer<Results> run(const skill::FieldList<Parameters>& parameter_list,
                               const Parameters& parameters,
                               const skill::FieldList<Results>& result_list, SteadyTime deadline);

    /// Sets the callback for each transition from now on, on the client's thread; an empty one ends
    /// it.
    void onTransition(std::function<void(const skill::TransitionEvent&)> callback);

private:
    struct Impl;
    void takeBack(const skill::ValueMap& parameters, const opcua::Failure& refusal);
    /// Halts the skill if its end did not come in time.
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
