#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "metier/skill/execution_handle.hpp"

namespace metier::skill {

/// Data that the handles of one execution share with its Program.
struct ExecutionCore {
    ExecutionCore(const std::shared_ptr<Executor>& owner, std::string execution_id,
                  ExecutionSink& program)
        : executor(owner), id(std::move(execution_id)), sink(&program) {}

    // Not shared: what waits in the executor's queue holds this.
    const std::weak_ptr<Executor> executor;
    const std::string id;
    /// Counts the requests to come to rest, so that a late answer to one is not taken for the
    /// answer to the next. Written by the owner's thread.
    std::atomic<std::uint32_t> stop_request{0};
    /// Empty once the execution has ended. Owner's thread only.
    ExecutionSink* sink;
};

/// Posts `tell` to the owner's thread; there it is called with the sink if the execution still goes
/// on. Any thread.
template <typename Tell>
void post(const std::shared_ptr<ExecutionCore>& core, Tell tell) {
    const auto executor = core ? core->executor.lock() : nullptr;
    if (!executor) {
        return;
    }
    executor->post([core, tell = std::move(tell)]() mutable {
        if (core->sink != nullptr) {
            tell(*core->sink);
        }
    });
}

}  // namespace metier::skill
