#include "metier/urscript/interpreter.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "code.hpp"
#include "thread.hpp"

namespace metier::urscript {
namespace {

constexpr std::int32_t kMainThread = -1;  // a handle that no script gets

bool isReady(const std::unique_ptr<Thread>& thread) {
    return thread->state() == Thread::State::ready;
}

}  // namespace

class Interpreter::Run final : public ThreadContext {
    friend class Interpreter;

public:
    Run(Program program, Robot& robot, RunLimits limits)
        : program_(std::move(program)),
          robot_(robot),
          limits_(limits),
          code_(*program_.code()),
          globals_(code_.globals.size()) {
        threads_.push_back(std::make_unique<Thread>(kMainThread, code_, 0));
    }

    RunState step();
    void end(RunState state);

    Robot& robot() override { return robot_; }
    const RunLimits& limits() const override { return limits_; }
    double random() override { return std::uniform_real_distribution<>()(random_); }
    Result<void> beginMotion(const Motion& motion) override;
    Result<bool> motionDone() override;
    std::vector<Value>& globals() override { return globals_; }
    bool spend(std::size_t instructions) override;
    bool mayWait() const override { return program_.kind() == ProgramKind::primary; }
    Result<std::int32_t> startThread(std::size_t function) override;
    void killThread(std::int32_t handle) override;
    bool isAlive(std::int32_t handle) const override { return find(handle) != nullptr; }

    std::optional<Value> variable(std::string_view name) const;

private:
    Thread* find(std::int32_t handle) const;
    void afterStep(const Thread& thread);
    void releaseMotion();
    void dropEnded();

    Program program_;
    Robot& robot_;
    RunLimits limits_;
    const Code& code_;  // code of program_
    std::vector<Value> globals_;
    std::vector<std::unique_ptr<Thread>> threads_;  // oldest first; the main thread is the first
    const Thread* current_ = nullptr;               // runs now
    std::optional<std::int32_t> mover_;             // the thread that moves the arm
    std::int32_t last_handle_ = 0;
    std::size_t spent_ = 0;  // instructions in this cycle
    RunState state_ = RunState::running;
    std::optional<RuntimeException> exception_;
    int line_ = 1;
    std::minstd_rand random_;
};

RunState Interpreter::Run::step() {
    spent_ = 0;
    // Loops by index, since threads that start now run in this cycle, too.
    for (std::size_t i = 0; i < threads_.size() && state_ == RunState::running; ++i) {
        Thread& thread = *threads_[i];
        current_ = &thread;
        thread.step(*this);
        current_ = nullptr;
        afterStep(thread);
    }
    dropEnded();
    if (state_ == RunState::running && !mayWait()) {
        end(RunState::finished);
    }
    return state_;
}

void Interpreter::Run::afterStep(const Thread& thread) {
    const bool is_main = thread.handle() == kMainThread;
    line_ = is_main ? thread.position().line : line_;
    switch (thread.state()) {
        case Thread::State::ready:
            return;
        case Thread::State::ended:
            if (is_main) {
                end(RunState::finished);
            }
            return;
        case Thread::State::halted:
            end(RunState::finished);
            return;
        case Thread::State::failed:
            exception_ = RuntimeException{thread.position().line, thread.position().column,
                                          thread.error().message};
            end(RunState::failed);
            return;
    }
}

void Interpreter::Run::end(RunState state) {
    if (state_ == RunState::running) {
        state_ = state;
        releaseMotion();
        for (const auto& thread : threads_) {
            thread->kill();
        }
        if (current_ == nullptr) {
            threads_.clear();
        }
    }
}

Result<void> Interpreter::Run::beginMotion(const Motion& motion) {
    if (!mayWait()) {
        return fail(Errc::not_supported, "a secondary program may not move the arm");
    }
    if (mover_ && *mover_ != current_->handle()) {
        return fail(Errc::invalid_state, "another thread is already controlling the robot");
    }
    auto begun = robot_.beginMotion(motion);
    if (begun) {
        mover_ = current_->handle();
    }
    return begun;
}

Result<bool> Interpreter::Run::motionDone() {
    auto done = robot_.motionDone();
    if (done && *done) {
        mover_.reset();
    }
    return done;
}

bool Interpreter::Run::spend(std::size_t instructions) {
    spent_ += instructions;
    return spent_ <= limits_.instructions_per_cycle;
}

Result<std::int32_t> Interpreter::Run::startThread(std::size_t function) {
    const auto alive = std::count_if(threads_.begin(), threads_.end(), isReady);
    if (static_cast<std::size_t>(alive) >= limits_.threads) {
        return fail(Errc::out_of_range,
                    "more than " + std::to_string(limits_.threads) + " threads");
    }
    ++last_handle_;
    threads_.push_back(std::make_unique<Thread>(last_handle_, code_, function));
    return last_handle_;
}

void Interpreter::Run::killThread(std::int32_t handle) {
    if (Thread* thread = find(handle)) {
        thread->kill();
        if (mover_ == handle) {
            releaseMotion();
        }
    }
}

void Interpreter::Run::releaseMotion() {
    if (mover_) {
        mover_.reset();
        robot_.abandonMotion();
    }
}

Thread* Interpreter::Run::find(std::int32_t handle) const {
    const auto found = std::find_if(threads_.begin(), threads_.end(), [&](const auto& thread) {
        return thread->handle() == handle && isReady(thread);
    });
    return found == threads_.end() || handle == kMainThread ? nullptr : found->get();
}

void Interpreter::Run::dropEnded() {
    threads_.erase(std::remove_if(threads_.begin(), threads_.end(), std::not_fn(isReady)),
                   threads_.end());
}

std::optional<Value> Interpreter::Run::variable(std::string_view name) const {
    const auto found = std::find(code_.globals.begin(), code_.globals.end(), name);
    if (found == code_.globals.end()) {
        return std::nullopt;
    }
    return globals_[static_cast<std::size_t>(found - code_.globals.begin())];
}

Interpreter::Interpreter(Program program, Robot& robot, RunLimits limits)
    : run_(std::make_unique<Run>(std::move(program), robot, limits)) {}
Interpreter::~Interpreter() {
    if (run_) {
        run_->end(RunState::finished);
    }
}
Interpreter::Interpreter(Interpreter&&) noexcept = default;
Interpreter& Interpreter::operator=(Interpreter&& other) noexcept {
    std::swap(run_, other.run_);
    return *this;
}

RunState Interpreter::step() {
    return run_->state_ == RunState::running ? run_->step() : state();
}
void Interpreter::stop() {
    run_->end(RunState::finished);
}
RunState Interpreter::state() const {
    return run_->state_;
}
const std::optional<RuntimeException>& Interpreter::exception() const {
    return run_->exception_;
}
int Interpreter::line() const {
    return run_->line_;
}
std::size_t Interpreter::threadCount() const {
    return run_->threads_.size();
}
std::optional<Value> Interpreter::variable(std::string_view name) const {
    return run_->variable(name);
}
const Program& Interpreter::program() const {
    return run_->program_;
}

}  // namespace metier::urscript
