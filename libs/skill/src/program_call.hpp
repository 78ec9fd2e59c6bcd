#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "metier/skill/program.hpp"

namespace metier::skill {

/// Data that the handles of one execution share with its Program.
struct ExecutionCore {
    ExecutionCore(const std::shared_ptr<Executor>& owner, std::string execution_id, Program& runs)
        : executor(owner), id(std::move(execution_id)), program(&runs) {}

    // Not shared: what waits in the executor's queue holds this.
    const std::weak_ptr<Executor> executor;
    const std::string id;
    /// Counts the requests to come to rest, so that a late answer to one is not taken for the
    /// answer to the next. Written by the owner's thread.
    std::atomic<std::uint32_t> stop_request{0};
    /// Null once the execution has ended. Owner's thread only.
    Program* program;
};

/// Calls into a skill or work; what it throws becomes an error.
template <typename Call>
auto guarded(Call call) {
    using Returned = std::invoke_result_t<Call>;
    using Outcome = std::conditional_t<std::is_void_v<Returned>, Result<void>, Returned>;
    try {
        if constexpr (std::is_void_v<Returned>) {
            call();
            return Outcome{};
        } else {
            return call();
        }
    } catch (const std::exception& error) {
        return Outcome(fail(Errc::internal, error.what()));
    } catch (...) {
        return Outcome(fail(Errc::internal, "the skill failed without saying why"));
    }
}

/// One call to the Program. What arrives during it waits until its end.
class Program::Call {
public:
    explicit Call(Program& program) : program_(program) { program_.busy_ = true; }
    ~Call() {
        while (!program_.deferred_.empty()) {
            for (const auto& work : std::exchange(program_.deferred_, {})) {
                work();
            }
        }
        program_.busy_ = false;
    }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

private:
    Program& program_;
};

template <typename Tell>
void Program::notify(Tell tell) {
    for (auto* observer : observers_) {
        tell(*observer);
    }
}

template <typename Work>
void Program::inCall(Work work) {
    if (busy_) {
        deferred_.emplace_back(std::move(work));
        return;
    }
    const Call call(*this);
    work();
}

template <typename Tell>
void Program::post(const std::shared_ptr<ExecutionCore>& core, Tell tell) {
    const auto executor = core ? core->executor.lock() : nullptr;
    if (!executor) {
        return;
    }
    auto tellIfOn = [core, tell = std::move(tell)]() mutable {
        if (core->program != nullptr) {
            tell(*core->program);
        }
    };
    executor->post([core, tell = std::move(tellIfOn)]() mutable {
        if (core->program != nullptr) {
            core->program->inCall(std::move(tell));
        }
    });
}

}  // namespace metier::skill
