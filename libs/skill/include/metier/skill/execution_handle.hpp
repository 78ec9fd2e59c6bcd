#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "metier/base/error.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/parent_execution.hpp"
#include "metier/skill/state.hpp"
#include "metier/skill/value.hpp"

namespace metier::skill {

struct ExecutionCore;

/// Handle by which the work of an execution reports its outcome and its progress to the Program
/// that runs it:
///
///     void start(ExecutionHandle execution) override {
///         device_.measure([execution](Result<double> value) {  // on any thread
///             value ? execution.finish({{"Weight", *value}})
///                   : execution.fail(Reason::error, value.error().message);
///         });
///     }
///
/// All copies report to the same Program. Calls that come late, twice, or after the Program is gone
/// change nothing. An empty handle ignores every call.
/// Threading: any thread; nothing waits. All but id() allocate: not for a cycle thread.
class ExecutionHandle {
public:
    /// An empty handle; the work gets the real one by ExecutionWork::start().
    ExecutionHandle() = default;
    /// For a Program: makes the first handle of an execution.
    explicit ExecutionHandle(std::shared_ptr<ExecutionCore> core);

    /// Id of this execution, unique over all executions, also across restarts; empty for an empty
    /// handle.
    const std::string& id() const noexcept;

    /// Reports that the work is done and the device stands still: Running becomes Ready. While a
    /// Halt is under way: Halted. While Suspended, the result is kept, and Resume makes the Program
    /// Ready.
    /// \param result values by the names of the declared results, in their units. A name that was
    ///               not declared is dropped; a declared one that is missing becomes Null. A value
    ///               of another type than declared ends the execution as Halted, error.
    void finish(ValueMap result = {}) const;
    /// Reports that the work ended in an error and the device stands still: Halted.
    /// \param reason error, force_exceeded, limit_violated or device_lost; by_client is taken
    ///               for error
    /// \param text   for the client, with value, limit and unit
    void fail(Reason reason, std::string text) const;
    /// Answers ExecutionWork::suspend() or ExecutionWork::halt(): the device stands still now. An
    /// answer to an earlier request than the latest is ignored.
    void atRest() const;
    /// Publishes the latest intermediate result; the following events of this execution carry it,
    /// too.
    void progress(Value intermediate) const;
    /// Publishes the step that a sequence is in, as a sub-state of Executing.
    /// \param name one of SkillDescription::steps
    void step(std::string name) const;
    /// Asks the Program to suspend the work, as a client's Suspend does; ExecutionWork::suspend()
    /// follows. Nothing changes if the work is already coming to rest or does not run. If the work
    /// cannot be suspended, it is halted with reason error.
    /// \param why for a person: who brought a part of the work to rest
    void suspend(std::string why) const;
    /// Reports that the work has started another skill, here or on another server; observers get it
    /// as onStarted().
    void started(StartedExecution child) const;

private:
    // Shared by the Program and all handles, since a handle may outlive the Program.
    std::shared_ptr<ExecutionCore> core_;
};

}  // namespace metier::skill
