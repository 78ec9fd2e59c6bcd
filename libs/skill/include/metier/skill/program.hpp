#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/skill/caller.hpp"
#include "metier/skill/control.hpp"
#include "metier/skill/execution_names.hpp"
#include "metier/skill/execution_record.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/parameter_set.hpp"
#include "metier/skill/program_observer.hpp"
#include "metier/skill/resource.hpp"
#include "metier/skill/skill.hpp"

namespace metier::skill {

/// Settings of a Program; the defaults suit a skill without device and owner.
///
/// The deadlines are timers of the Executor: a busy owner's thread delays them.
struct ProgramOptions {
    /// The device that the skill needs for itself; empty: none. Shared by the Programs of a device:
    /// while one holds it, a Start of the others is resource_unavailable.
    std::shared_ptr<Resource> resource{};
    /// Right to command; empty: everybody may. Shared by the Programs of a controller.
    std::shared_ptr<Control> control{};
    /// Names that executions have had; empty: the Program keeps its own, as long as it lives.
    /// Shared by the Programs of a server.
    std::shared_ptr<ExecutionNames> names{};
    /// Longest time between the last write to the parameter set and Start; then the binding ends
    /// and the values fall back to their defaults. Each write begins it anew.
    std::chrono::milliseconds configuration_timeout{10'000};
    /// Longest time that work may take to come to rest after a Suspend or Halt; then the device's
    /// own stop is used, and the Program is Halted.
    std::chrono::milliseconds rest_deadline{5'000};
    /// Longest time until the name of an execution is on disk; then the execution is Halted, error,
    /// and nothing has moved.
    std::chrono::milliseconds name_deadline{1'000};
    /// Client that made the Program, for ProgramDiagnostic; empty: the server itself.
    Caller creator{};
};

/// A Start that carries its parameters with it: the arguments of the Method StartWith.
///
///     const auto id = program.startWith(caller, {.execution_id = "order-17",
///                                                .parameters = {{"Height", 0.3}},
///                                                .on_owner_loss = OwnerLossAction::halt});
///     // A repeated call with the same id starts nothing and returns the id again.
struct StartRequest {
    /// Name of the execution, at most 128 bytes; empty: the Program makes one.
    std::string execution_id{};
    /// Values by name, in the units of their fields; the others take their defaults.
    ValueMap parameters{};
    /// Action when the owner is lost; skill_default leaves it to the lease, and then to the skill.
    OwnerLossAction on_owner_loss = OwnerLossAction::skill_default;
    /// Epoch of the caller's lease, from Control::acquire(); 0: none is needed.
    std::uint64_t epoch = 0;
    /// Time by the server's wall clock after which the start is refused; none: no deadline.
    std::optional<UtcTime> deadline{};
    /// Execution on whose behalf it starts; passed on to records, never checked.
    ParentExecution parent{};
};

/// The state machine of one skill (OPC 10000-10). Nothing else changes the state:
///
///     Program program({}, std::make_unique<WaveSkill>(), executor, clock);
///     program.attach(observer);
///     auto id = program.startWith(caller, {.parameters = {{"Height", 0.3}}});
///
/// It begins Ready. Halted and Suspended mean that the device stands still: Halt and Suspend of a
/// running work return at once, and the transition follows when the work is at rest. What an
/// execution reports, and a loss of owner or device, is handled right after the call that is under
/// way.
/// Notifications of one transition come in this order: onSubState(), onDiagnostic(),
/// onTransition(). Observers see the new state in all of them.
/// Errors of every method: invalid_state if the current state does not allow it, or from inside a
/// notification; locked if another session has control (Halt excepted). Nothing changes then. An
/// exception of the skill or its work counts as an error of code internal.
/// Threading: every call on the owner's thread, which is the Executor's. Nothing blocks.
class Program final : private Control::Listener {
public:
    /// \param skill    must not be null; the Program owns it
    /// \param executor shared by the Programs of a thread
    /// \param clock    must outlive the Program
    /// Throws std::invalid_argument without a skill, for a default value that its field refuses, or
    /// for two fields of one name.
    Program(ProgramOptions options, std::unique_ptr<Skill> skill,
            std::shared_ptr<Executor> executor, const Clock& clock);
    /// Stops the device by ExecutionWork::forceStop() if the Program is Running; observers get no
    /// transition. Must not be called from inside a call of its own to work or an observer.
    ~Program() override;
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    /// Adds an observer, called after those that were added before. It must outlive the Program or
    /// be detached. Not allowed from inside a notification.
    void attach(ProgramObserver& observer);
    /// Ends the calls to an observer; nothing happens if it is not attached. Not allowed from
    /// inside a notification.
    void detach(ProgramObserver& observer);

    /// Writes a parameter; Null means its default. In Ready this binds the parameter set to the
    /// caller's session until Start, the session's end or the configuration timeout. While
    /// Executing only live parameters may be written, by the session that owns the execution.
    /// \param meant_for time for which a live value is meant, by the writer's clock; not used in
    ///                  Ready
    /// Errors: not_found; type_mismatch, out_of_range; locked (another session has control, has
    ///         bound the set or has started the skill); invalid_state; for a live value also any
    ///         error of ExecutionWork::input(). The old value stays.
    Result<void> write(const Caller& caller, std::string_view parameter, Value value,
                       std::optional<UtcTime> meant_for = {});
    /// Present value of a parameter; Null if it has neither a value nor a default. While Running,
    /// not the value that the execution has taken, but the default or the last live value.
    /// Errors: not_found.
    Result<Value> read(std::string_view parameter) const;

    /// Checks the parameters as a whole and begins: Running when this returns.
    /// Errors: locked; resource_unavailable (the device, or the disk for names); invalid_argument
    ///         (a parameter is missing); any error of Skill::prepare(). Nothing has changed then;
    ///         the written values stay.
    Result<void> start(const Caller& caller);
    /// Checks all given parameters, takes them and begins, or changes nothing. Values that the
    /// session has written before are dropped. A named execution is Running at once, but its work
    /// starts once the name is on disk.
    /// \return the execution's id. An id of this Program's last ExecutionHistory::kMost executions
    /// starts nothing, in any state: the id of that execution, running or over, is returned.
    /// Errors: as start() and write(); out_of_range (an id over 128 bytes); locked (epoch); timeout
    ///         (deadline); already_exists (an execution of that id has begun, and its record is
    ///         gone).
    Result<std::string> startWith(const Caller& caller, StartRequest request);
    /// Makes the checks of startWith() and describes the motion. Nothing changes; observers get
    /// onCheck(). Plans as Start does, so it takes as long. Other skills are not asked.
    /// \return a report that is not possible, with the error's text, where startWith() would be
    /// refused
    CheckReport check(const Caller& caller, const ValueMap& parameters);
    /// As check(), for arms that may stand elsewhere by then; a composed skill asks the skills that
    /// it uses.
    /// \param done called once, in this call or later on the owner's thread, not after the end of
    ///             the Program
    /// Errors, given to `done`: timeout: the answer is not known; ask again.
    void check(const Caller& caller, const CheckRequest& request, CheckDone done);
    /// Record of an execution; the last ExecutionHistory::kMost are kept.
    /// Errors: not_found; the text says whether an execution of that id has begun once.
    Result<ExecutionRecord> execution(std::string_view id) const;
    /// The last executions; 0 is the latest. Null if there were fewer. Valid until the next one
    /// begins.
    const ExecutionRecord* recentExecution(std::size_t back) const noexcept {
        return history_.recent(back);
    }

    /// Asks the work to come to rest on its path; Suspended follows at standstill, at most
    /// ProgramOptions::rest_deadline later, or else Halted.
    /// Errors: not_supported (the skill cannot be suspended); any error of
    ///         ExecutionWork::suspend(): the execution goes on.
    Result<void> suspend(const Caller& caller);
    /// Continues a suspended execution. If its owner is gone, the caller becomes its owner.
    /// Errors: any error of ExecutionWork::resume(); the Program stays Suspended.
    Result<void> resume(const Caller& caller);
    /// Brakes; Halted follows at standstill, at most ProgramOptions::rest_deadline later. Allowed
    /// to any caller, also while a Halt is under way, which then goes on unchanged. From Ready and
    /// Suspended: Halted when this returns.
    Result<void> halt(const Caller& caller);
    /// From Halted: becomes Ready if the skill agrees. From Suspended: gives the execution up, and
    /// is Ready.
    /// Errors: any error of Skill::reset(), such as timeout while the device has not finished; the
    ///         Program stays Halted and shows the reason.
    Result<void> reset(const Caller& caller);
    /// Whether `caller` may call `method` now: state, control, device and binding allow it. The
    /// parameters are not checked.
    bool executable(Method method, const Caller& caller) const;

    /// Ends the session's binding of the parameters; if it owns the execution, that has lost its
    /// owner. Call it for every session that has ended.
    void sessionClosed(std::string_view session_id);
    /// Handles that the owner of the execution is gone. The start's OnOwnerLoss decides what
    /// happens; if it left that open, `action` does; else the skill. Nothing happens without an
    /// execution.
    /// \param text reason, for a person
    void ownerLost(std::string text, OwnerLossAction action = OwnerLossAction::skill_default);
    /// Handles the loss of the device: Halted at once, from every state; the work is stopped by
    /// forceStop().
    /// \param text reason, for a person; names the device
    void deviceLost(std::string text);
    /// Handles that somebody else has stopped the device: a running Program is Halted with an error
    /// at standstill.
    /// \param text reason, for a person
    void deviceStopped(std::string text);
    /// Handles that the device does nothing until it is reset: a Ready Program is Halted with an
    /// error. A running one notices by its motion; if it still ends Ready, it is Halted right
    /// after.
    /// \param text reason, for a person
    void deviceNotReady(std::string text);
    /// The device may be used again, without a Reset of this Program.
    void deviceReady();

    /// Executor of the Program's thread.
    Executor& executor() const { return *executor_; }
    /// Description of the skill; valid as long as the Program.
    const SkillDescription& description() const { return description_; }
    /// Present state. It changes only in a call of this class or in work of the executor.
    State state() const noexcept { return state_; }
    /// Present sub-state; none while Suspended.
    SubState subState() const noexcept { return sub_state_; }
    /// Present step of a sequence; empty unless an execution is under way.
    const std::string& step() const noexcept { return step_; }
    /// Latest intermediate result; Null unless an execution is under way and has reported one.
    const Value& intermediate() const noexcept { return intermediate_; }
    /// Id of the execution that is under way, or else of the last one; empty before the first.
    const std::string& executionId() const noexcept { return execution_id_; }
    /// Reason of the last transition; device_lost if the device was lost while Halted; none before
    /// the first transition.
    Reason reason() const noexcept { return reason_; }
    /// Text for a person, with value, limit and unit; after a refused Reset, its error. May be
    /// empty.
    const std::string& reasonText() const noexcept { return reason_text_; }
    /// Last transition; empty before the first.
    const std::optional<TransitionEvent>& lastTransition() const noexcept { return last_; }
    /// Content of ProgramDiagnostic; valid as long as the Program, changes with each call.
    const Diagnostic& diagnostic() const noexcept { return diagnostic_; }
    /// Result of the last execution that finished, every declared field; Null before the first.
    const ValueMap& finalResult() const noexcept { return final_result_; }
    /// Present values of all parameters, as read(); valid as long as the Program.
    const ValueMap& parameters() const noexcept { return parameters_.values(); }

private:
    friend class ExecutionHandle;
    class Call;
    /// Reason and text of a transition.
    struct Cause {
        Reason reason = Reason::by_client;
        std::string text{};
    };

    // Reports of the execution's handles.
    // They come from any thread and are posted to the owner's; a report of an execution that is
    // over is dropped.
    void finish(ValueMap result);
    void fail(Reason reason, std::string text);
    void takeRest(std::uint32_t stop_request);
    void takeProgress(Value intermediate);
    void takeStep(std::string name);
    void suspendAsked(const std::string& why);
    void nameKept(const Result<void>& kept);
    void onControlLost(std::string_view session, OwnerLossAction action,
                       const std::string& text) override;

    /// Does `work` if `method` is allowed now; records who called it and how it went.
    template <typename Work>
    Result<void> command(Method method, const Caller& caller, Work work);
    /// Does `work` now, or right after the call that is under way.
    template <typename Work>
    void inCall(Work work);
    template <typename Tell>
    void notify(Tell tell);
    /// Posts `tell` to the owner's thread; there it is called with the Program, as inCall() does,
    /// if the execution still goes on. Any thread.
    template <typename Tell>
    static void post(const std::shared_ptr<ExecutionCore>& core, Tell tell);

    /// Whether the present state allows the method.
    bool allows(Method method) const noexcept;
    /// Checks state and control. Errors: invalid_state, with the way out of Halted; locked.
    Result<void> checkAllowed(Method method, const Caller& caller) const;
    std::string wayOut() const;
    Result<void> checkControl(const Caller& caller) const;
    /// Writes the call, and then its outcome, to ProgramDiagnostic.
    void recordCall(Method method, const Caller& caller);
    void recordStatus(const Result<void>& status);

    /// Writes before a Start, and binds the parameters to the session.
    Result<void> writeReady(const Caller& caller, const Field& field, Value value);
    /// Hands a value to the running work.
    Result<void> writeLive(const Caller& caller, const Field& field, const LiveValue& live);
    Result<Value> takeLive(const Field& field, const LiveValue& live);
    Result<void> startWithNow(const Caller& caller, StartRequest& request);
    Result<void> checkFree(const Caller& caller) const;
    Result<void> checkEpoch(const Caller& caller, std::uint64_t epoch) const;
    /// Facts that a Start gives of its execution.
    struct Order {
        std::string id{};  ///< empty: the Program makes one
        OwnerLossAction on_owner_loss = OwnerLossAction::skill_default;
        ParentExecution parent{};
    };
    Result<void> begin(const Caller& caller, std::shared_ptr<const ValueMap> snapshot, Order order);
    Result<void> noteName(const std::shared_ptr<ExecutionCore>& core);
    void startWork();
    void nameDeadlinePassed();
    Result<CheckReport> checkNow(const Caller& caller, const ValueMap& parameters);
    /// Values of all parameters, if Start would be allowed now.
    Result<ValueMap> checkable(const Caller& caller, const ValueMap& parameters) const;
    void noteCheck(const Caller& caller, const ValueMap& parameters, const CheckReport& report);
    Result<void> suspendNow(Cause cause);
    void actOnOwnerLoss(OwnerLossAction action, std::string text);
    void noteInHistory();
    Result<void> resumeNow(const Caller& caller);

    Result<void> takeResult(ValueMap& result);
    void brake(Cause cause);
    void announceRest(State to, const Cause& cause);
    void armRestDeadline();
    void restDeadlinePassed();
    void forceHalted(Cause cause);
    void halted(Cause cause);
    void giveUpSuspended();
    const Cause* stopCause() const;
    std::string whyStopping() const;
    void end(TransitionNumber transition, Cause cause);
    void endExecution();

    void armConfigurationTimeout(std::chrono::nanoseconds delay);
    void configurationTimedOut();
    void endConfiguration();
    void releaseParameters();

    // The one place where state_ changes; everything that clients see of a transition is set here.
    void commit(TransitionNumber transition, Cause cause);
    void setSubState(SubState sub_state);

    ProgramOptions options_;
    std::unique_ptr<Skill> skill_;
    // Description that skill_ keeps.
    const SkillDescription& description_;
    // Shared by the Programs of its thread.
    std::shared_ptr<Executor> executor_;
    const Clock& clock_;
    // Not owned; in the order of attach().
    std::vector<ProgramObserver*> observers_;
    ParameterSet parameters_;
    // An entry for every declared result, Null before the first execution that finished.
    ValueMap final_result_;
    Diagnostic diagnostic_;

    State state_ = State::ready;
    SubState sub_state_ = SubState::ready_not_configured;
    std::string step_;
    Reason reason_ = Reason::none;
    std::string reason_text_;
    std::optional<TransitionEvent> last_;

    // Random prefix of the execution ids that the Program makes itself, so that none comes again
    // after a restart.
    std::string boot_id_;
    std::uint64_t execution_count_ = 0;
    ExecutionHistory history_;
    std::string execution_id_;
    // Session that owns the execution; empty once it is lost.
    std::string owner_session_;
    OwnerLossAction on_owner_loss_ = OwnerLossAction::skill_default;
    Value intermediate_;
    // Shared with the work's handles; the Program takes itself out when the execution ends.
    std::shared_ptr<ExecutionCore> execution_;
    std::unique_ptr<ExecutionWork> work_;
    // The name of the execution under way is on disk, or need not be: its work may start.
    bool name_kept_ = true;
    // ExecutionWork::start() was called; nothing moves before.
    bool work_started_ = false;
    // Cause of a Halt that is under way, of a Suspend, and why the device needs a Reset once the
    // execution is over.
    std::optional<Cause> halting_;
    std::optional<Cause> suspending_;
    std::optional<Cause> not_ready_;
    // Result of work that reached its end although it was asked to suspend.
    std::optional<ValueMap> finished_while_suspended_;

    // Time of the last write to the parameter set; configuration_timer_ looks at it.
    SteadyTime last_write_;
    Timer configuration_timer_;
    Timer rest_timer_;
    Timer name_timer_;
    // A call is under way: commands are refused, and the work of inCall() waits in deferred_.
    bool busy_ = false;
    bool diagnostic_reported_ = true;
    std::vector<std::function<void()>> deferred_;
};

}  // namespace metier::skill
