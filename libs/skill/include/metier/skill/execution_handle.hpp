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
/// that runs it.
///
/// All copies report to the same Program. Calls that come late, twice, or after the Program is gone
/// change nothing. An empty handle ignores every call.
/// Threading: any thread; nothing waits. All but id() allocate: not for a cycle thread.
class ExecutionHandle {
public:
    ExecutionHandle() = default;
    /// For a Program: makes the first handle of an execution.
    explicit ExecutionHandle(std::shared_ptr<ExecutionCore> core);

    /// Id of this execution, unique over all executions, also across restarts; empty for an empty
    /// handle.
    const std::string& id() const noexcept;

    /// The work is done and the device stands still: Running becomes Ready. A result that was not
    /// declared is dropped. While a Halt is under way: Halted.
    void finish(ValueMap result = {}) const;
    /// The work ended in an error and the device stands still: Halted.
    /// \param reason error, force_exceeded, limit_violated or device_lost
    /// \param text   for the client, with value, limit and unit
    void fail(Reason reason, std::string text) const;
    /// Answers ExecutionWork::suspend() or ExecutionWork::halt(): the device stands still now.
    void atRest() const;
    /// Publishes the latest intermediate result; the following events carry it, too.
    void progress(Value intermediate) const;
    /// Publishes the step that a sequence is in, as a sub-state of Executing.
    void step(std::string name) const;
    /// Asks the Program to suspend the work, as a client's Suspend does; ExecutionWork::suspend()
    /// follows. Nothing changes if the work is already coming to rest or does not run.
    /// \param why for a person: who brought a part of the work to rest
    void suspend(std::string why) const;
    /// Reports that the work has started another skill, here or on another server.
    void started(StartedExecution child) const;

private:
    // Shared by the Program and all handles, since a handle may outlive the Program.
    std::shared_ptr<ExecutionCore> core_;
};

}  // namespace metier::skill
