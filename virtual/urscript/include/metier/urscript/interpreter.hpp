#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "metier/urscript/program.hpp"
#include "metier/urscript/robot.hpp"
#include "metier/urscript/value.hpp"

namespace metier::urscript {

/// Why a program ended early; what the controller tells primary clients as runtime exception.
struct RuntimeException {
    int line = 0;    ///< from 1
    int column = 0;  ///< from 1
    std::string text;
};

enum class RunState {
    running,
    finished,  ///< reached its end, `halt`, or was stopped
    failed,    ///< by a runtime exception
};

/// What a program may use up.
struct RunLimits {
    /// Instructions of all threads together in one cycle; more is a runtime exception: a loop
    /// without sync(), sleep() or another call that takes time.
    std::size_t instructions_per_cycle = 100'000;
    std::size_t threads = 64;
    std::size_t call_depth = 200;
    std::size_t list_length = 100'000;
    std::size_t text_length = 100'000;
};

/// Runs one program, one controller cycle after the other.
///
/// In each cycle every thread of the script, oldest first, runs until it calls what takes time:
/// sync(), sleep(), a motion, a read that has to wait, a blocking popup, join. A thread that is
/// started runs first in the same cycle. Within a critical section nothing changes by this: a
/// thread is never interrupted elsewhere.
///
/// When it ends, motions are abandoned; sockets and force mode are left to the owner, who closes
/// and ends them, as the controller does.
/// Threading: one thread, which owns it; no threads of its own, no clock: time is counted in
/// cycles.
class Interpreter {
public:
    /// \param robot outlives the interpreter
    Interpreter(Program program, Robot& robot, RunLimits limits = {});
    ~Interpreter();
    Interpreter(Interpreter&&) noexcept;
    Interpreter& operator=(Interpreter&&) noexcept;

    /// Runs one cycle. Does nothing once the program has ended. A secondary program ends in its
    /// first cycle: what would take time, or move the arm, is a runtime exception in it.
    RunState step();
    /// Ends the program from outside: stop button, safety, another program.
    void stop();

    RunState state() const;
    /// Why it failed; empty unless state() is failed.
    const std::optional<RuntimeException>& exception() const;
    /// Where the main thread is, from 1: RTDE's script_control_line.
    int line() const;
    /// Threads of the script that have not ended, the main thread too.
    std::size_t threadCount() const;
    /// A variable of the program's own scope or a global one; empty if there is none.
    std::optional<Value> variable(std::string_view name) const;
    const Program& program() const;

private:
    class Run;
    std::unique_ptr<Run> run_;
};

}  // namespace metier::urscript
