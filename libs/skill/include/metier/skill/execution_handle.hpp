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

/// Who hears what an Execution tells; a Program. Called on the owner's thread.
class ExecutionSink {
public:
    virtual ~ExecutionSink() = default;
    virtual void onFinish(ValueMap result) = 0;
    virtual void onFail(Reason reason, std::string text) = 0;
    /// \param stop_request which of the requests to stop is answered, see ExecutionCore
    virtual void onAtRest(std::uint32_t stop_request) = 0;
    virtual void onProgress(Value intermediate) = 0;
    virtual void onStep(std::string name) = 0;
    virtual void onStarted(StartedExecution child) = 0;
    /// The name of the execution is on disk, or why it is not.
    virtual void onNameKept(Result<void> kept) = 0;
    virtual void onSuspendAsked(std::string why) = 0;
};

struct ExecutionCore;

/// Work's handle to the Program that runs it: by it the work tells what became of the work.
///
/// Copies tell the same Program. Calls that come late, twice, or after the Program is gone change
/// nothing. An empty handle ignores every call.
/// Threading: any thread; nothing waits. All but id() allocate: not for a cycle thread.
class ExecutionHandle {
public:
    ExecutionHandle() = default;
    explicit ExecutionHandle(std::shared_ptr<ExecutionCore> core);

    /// Unique over all executions, also across restarts; empty for an empty handle.
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
    /// The latest intermediate result; part of the following events.
    void progress(Value intermediate) const;
    /// The step that a sequence is in, shown as a sub-state of Executing.
    void step(std::string name) const;
    /// Has the Program suspend the work, as a client's Suspend does: ExecutionWork::suspend() follows. While
    /// it comes to rest already, or does not run, nothing changes.
    /// \param why for a person: who brought a part of the work to rest
    void suspend(std::string why) const;
    /// The work has another skill started, here or elsewhere.
    void started(StartedExecution child) const;

private:
    // Shared by the Program and all handles, since a handle may outlive the Program.
    std::shared_ptr<ExecutionCore> core_;
};

}  // namespace metier::skill
