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
struct ProgramOptions {
    /// The device that the skill needs for itself; empty: none. Shared by the Programs of a device.
    std::shared_ptr<Resource> resource{};
    /// Right to command; empty: everybody may. Shared by the Programs of a controller.
    std::shared_ptr<Control> control{};
    /// Names that executions have had; empty: the Program keeps its own, as long as it lives.
    /// Shared by the Programs of a server.
    std::shared_ptr<ExecutionNames> names{};
    /// Longest time between a write to the parameter set and Start; then the binding ends.
    std::chrono::milliseconds configuration_timeout{10'000};
    /// Longest time that work may take to come to rest; then the device's own stop is used.
    std::chrono::milliseconds rest_deadline{5'000};
    /// Longest time until the name of an execution is on disk; then the execution is given up.
    std::chrono::milliseconds name_deadline{1'000};
    /// Client that made the Program; empty: the server itself.
    Caller creator{};
};

/// A Start that carries its parameters with it.
struct StartRequest {
    /// Name of the execution, at most 128 characters; empty: the Program makes one.
    std::string execution_id{};
    ValueMap parameters{};  ///< by name; the others take their defaults
    /// Action when the owner is lost.
    OwnerLossAction on_owner_loss = OwnerLossAction::skill_default;
    std::uint64_t epoch = 0;            ///< epoch of the caller's lease; 0: none is needed
    std::optional<UtcTime> deadline{};  ///< refused after that time; none: no deadline
    ParentExecution parent{};           ///< execution on whose behalf; passed on, never checked
};

/// The state machine of one skill. Nothing else changes the state.
///
/// It begins Ready. Halted and Suspended mean that the device stands still: Halt and Suspend of a
/// running work return at once, and the transition follows when the work is at rest.
/// Errors of every method: invalid_state if the current state does not allow it (nothing changes).
/// Threading: every call on the owner's thread, which is the Executor's. Nothing blocks.
class Program final : private Control::Listener {
public:
    /// \param executor shared by the Programs of a thread
    /// \param clock    must outlive the Program
    Program(ProgramOptions options, std::unique_ptr<Skill> skill,
            std::shared_ptr<Executor> executor, const Clock& clock);
    /// Stops the device by ExecutionWork::forceStop() if the Program is Running; observers get no
    /// transition. Must not be called from inside a call of its own to work or an observer.
    ~Program() override;
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    /// `observer` must outlive the Program or be detached. Not allowed from inside a notification.
    void attach(ProgramObserver& observer);
    void detach(ProgramObserver& observer);

    /// Writes a parameter; Null means its default. In Ready this binds the parameter set to the
    /// caller's session until Start, the session's end or the configuration timeout. In Running
    /// only live parameters may be written.
    /// \param meant_for time for which a live value is meant, by the writer's clock
    /// Errors: not_found; type_mismatch, out_of_range; locked (bound to, or started by, another
    ///         session); invalid_state. The old value stays.
    Result<void> write(const Caller& caller, std::string_view parameter, Value value,
                       std::optional<UtcTime> meant_for = {});
    /// Present value of a parameter; Null if there is none.
    /// Errors: not_found.
    Result<Value> read(std::string_view parameter) const;

    /// Checks the parameters as a whole and begins.
    /// Errors: locked; resource_unavailable; invalid_argument (a parameter is missing); any error
    /// of Skill::prepare(). Nothing has changed then; the written values stay.
    Result<void> start(const Caller& caller);
    /// Checks all given parameters, takes them and begins, or changes nothing. Values that the
    /// session has written before are dropped.
    /// \return the execution's id. An id that the Program knows already starts nothing: the id of
    ///         that execution, running or over, is returned.
    /// Errors: as start() and write(); locked (epoch); timeout (deadline); already_exists (an
    /// execution of that id has begun, and its record is gone).
    Result<std::string> startWith(const Caller& caller, StartRequest request);
    /// Makes the checks of startWith() and describes the motion. Nothing changes.
    CheckReport check(const Caller& caller, const ValueMap& parameters);
    /// Record of an execution; the last ExecutionHistory::kMost are kept.
    /// Errors: not_found.
    Result<ExecutionRecord> execution(std::string_view id) const;
    /// The last executions; 0 is the latest. Null if there were fewer. Valid until the next one
    /// begins.
    const ExecutionRecord* recentExecution(std::size_t back) const noexcept {
        return history_.recent(back);
    }

    /// Asks the work to come to rest; Suspended follows at standstill.
    /// Errors: not_supported (the skill cannot be suspended); any error of
    /// ExecutionWork::suspend().
    Result<void> suspend(const Caller& caller);
    /// Continues a suspended execution. If its owner is gone, the caller becomes its owner.
    /// Errors: any error of ExecutionWork::resume(); the Program stays Suspended.
    Result<void> resume(const Caller& caller);
    /// Brakes; Halted follows at standstill. Allowed to any caller, also while a Halt is under way.
    Result<void> halt(const Caller& caller);
    /// From Halted: becomes Ready if the skill agrees. From Suspended: gives the execution up.
    /// Errors: any error of Skill::reset(); the Program stays Halted and shows the reason.
    Result<void> reset(const Caller& caller);
    /// Whether `caller` may call `method` now.
    bool executable(Method method, const Caller& caller) const;

    /// A session has ended: its binding of the parameters ends, and its execution has lost its
    /// owner.
    void sessionClosed(std::string_view session_id);
    /// The owner of the execution is gone. The start's OnOwnerLoss says what happens; if it left
    /// that open, `action` does; else the skill.
    void ownerLost(std::string text, OwnerLossAction action = OwnerLossAction::skill_default);
    /// The device is lost: Halted at once, from every state.
    void deviceLost(std::string text);
    /// The device was stopped by somebody else: a running Program is Halted with an error at
    /// standstill.
    void deviceStopped(std::string text);
    /// The device does nothing until it is reset: a Ready Program is Halted with an error. A
    /// running one notices by its motion; if it still ends Ready, it is Halted right after.
    void deviceNotReady(std::string text);
    /// The device may be used again, without a Reset of this Program.
    void deviceReady();

    /// Executor of the Program's thread.
    Executor& executor() const { return *executor_; }
    const SkillDescription& description() const { return description_; }
    State state() const noexcept { return state_; }
    SubState subState() const noexcept { return sub_state_; }
    /// Present step of a sequence; empty unless an execution is under way.
    const std::string& step() const noexcept { return step_; }
    /// Latest intermediate result; Null unless an execution is under way and has reported one.
    const Value& intermediate() const noexcept { return intermediate_; }
    /// Id of the execution that is under way, or else of the last one; empty before the first.
    const std::string& executionId() const noexcept { return execution_id_; }
    /// Reason of the last transition, or of a refused Reset.
    Reason reason() const noexcept { return reason_; }
    const std::string& reasonText() const noexcept { return reason_text_; }
    /// Last transition; empty before the first.
    const std::optional<TransitionEvent>& lastTransition() const noexcept { return last_; }
    const Diagnostic& diagnostic() const noexcept { return diagnostic_; }
    /// Result of the last execution that finished, every declared field; Null before the first.
    const ValueMap& finalResult() const noexcept { return final_result_; }
    const ValueMap& parameters() const noexcept { return parameters_.values(); }

private:
    friend class ExecutionHandle;
    class Call;
    struct Cause {
        Reason reason = Reason::by_client;
        std::string text{};
    };

    // Reports of the execution's handles.
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

    bool allows(Method method) const noexcept;
    Result<void> checkAllowed(Method method, const Caller& caller) const;
    std::string wayOut() const;
    Result<void> checkControl(const Caller& caller) const;
    void recordCall(Method method, const Caller& caller);
    void recordStatus(const Result<void>& status);

    Result<void> writeReady(const Caller& caller, const Field& field, Value value);
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

    void commit(TransitionNumber transition, Cause cause);
    void setSubState(SubState sub_state);

    ProgramOptions options_;
    std::unique_ptr<Skill> skill_;
    const SkillDescription& description_;
    // Shared by the Programs of its thread.
    std::shared_ptr<Executor> executor_;
    const Clock& clock_;
    std::vector<ProgramObserver*> observers_;
    ParameterSet parameters_;
    ValueMap final_result_;
    Diagnostic diagnostic_;

    State state_ = State::ready;
    SubState sub_state_ = SubState::ready_not_configured;
    std::string step_;
    Reason reason_ = Reason::none;
    std::string reason_text_;
    std::optional<TransitionEvent> last_;

    std::string boot_id_;
    std::uint64_t execution_count_ = 0;
    ExecutionHistory history_;
    std::string execution_id_;
    std::string owner_session_;
    OwnerLossAction on_owner_loss_ = OwnerLossAction::skill_default;
    Value intermediate_;
    // Shared with the work's handles; the Program takes itself out when the execution ends.
    std::shared_ptr<ExecutionCore> execution_;
    std::unique_ptr<ExecutionWork> work_;
    bool name_kept_ = true;      ///< of the execution under way: its work may start
    bool work_started_ = false;  ///< nothing moves before
    std::optional<Cause> halting_;
    std::optional<Cause> suspending_;
    std::optional<Cause> not_ready_;  ///< why the device needs a Reset, once the execution is over
    std::optional<ValueMap> finished_while_suspended_;

    SteadyTime last_write_;
    Timer configuration_timer_;
    Timer rest_timer_;
    Timer name_timer_;
    bool busy_ = false;
    bool diagnostic_reported_ = true;
    std::vector<std::function<void()>> deferred_;
};

}  // namespace metier::skill
