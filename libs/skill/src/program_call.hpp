#pragma once

#include <exception>
#include <type_traits>
#include <utility>

#include "metier/skill/program.hpp"

namespace metier::skill {

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

}  // namespace metier::skill
