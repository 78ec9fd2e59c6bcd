#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "call.hpp"
#include "code.hpp"

namespace metier::urscript {

/// Access of a thread to its program.
class ThreadContext : public CallContext {
public:
    virtual std::vector<Value>& globals() = 0;
    /// Counts work; false if the cycle's budget is spent.
    virtual bool spend(std::size_t instructions) = 0;
    /// Reports whether a thread may take more than this cycle.
    virtual bool mayWait() const = 0;
    /// \return its handle. Errors: out_of_range (too many).
    virtual Result<std::int32_t> startThread(std::size_t function) = 0;
    virtual void killThread(std::int32_t handle) = 0;
    virtual bool isAlive(std::int32_t handle) const = 0;
};

/// One thread of a script: its stack, and where it is.
class Thread {
public:
    enum class State {
        ready,   ///< runs on in the next cycle, or waits for something
        ended,   ///< reached its end, or was killed
        halted,  ///< wants the whole program to end
        failed,  ///< see error()
    };

    /// The main thread of a program, or `function` started by run.
    Thread(std::int32_t handle, const Code& code, std::size_t function);

    /// Runs until it waits or ends.
    State step(ThreadContext& context);
    void kill() { state_ = State::ended; }
    State state() const { return state_; }
    std::int32_t handle() const { return handle_; }
    /// Position of the instruction that is being executed.
    Position position() const { return at_; }
    const Error& error() const { return error_; }

private:
    struct Frame {
        const Function* function = nullptr;
        std::size_t next = 0;  // instruction
        std::size_t base = 0;  // index of its first local variable in the stack
    };

    Result<void> resume(ThreadContext& context);
    Result<void> execute(const Instruction& instruction, ThreadContext& context);
    Result<void> executeRare(const Instruction& instruction, ThreadContext& context);
    Result<void> load(const Value& value, std::string_view name, ThreadContext& context);
    Result<void> binary(Op op, ThreadContext& context);
    Result<void> element(std::size_t indices, ThreadContext& context);
    Result<void> setElement(Value& target, std::size_t indices, ThreadContext& context);
    Result<void> makeList(std::size_t count, ThreadContext& context);
    Result<void> makePose();
    Result<void> jumpIfFalse(const Instruction& instruction);
    Result<void> call(const FunctionCall& call, ThreadContext& context);
    Result<void> callBuiltin(const BuiltinCall& call, ThreadContext& context);
    Result<void> join(ThreadContext& context);
    Result<void> waitFor(Wait wait, const ThreadContext& context);
    void giveBack();
    void arrange(const std::vector<std::uint8_t>& parameter, std::size_t total);
    Result<void> push(Result<Value> value, ThreadContext& context);
    Value pop();
    Value& local(std::int32_t index);

    std::int32_t handle_;
    const Code& code_;
    std::vector<Frame> frames_;
    std::vector<Value> stack_;
    Wait wait_;
    State state_ = State::ready;
    Position at_;
    Error error_;
};

}  // namespace metier::urscript
