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

/// Reason why a program ended early; the controller sends it to primary clients as a runtime
/// exception.
struct RuntimeException {
    /// Line in the script, from 1.
    int line = 0;
    /// Column in that line, from 1.
    int column = 0;
    /// Text for a person.
    std::string text;
};

/// State of a program.
enum class RunState {
    /// It goes on with the next cycle.
    running,
    /// It reached its end, `halt`, or was stopped.
    finished,
    /// It ended by a runtime exception.
    failed,
};

/// Limits of the resources of a program.
struct RunLimits {
    /// Largest number of instructions of all threads together in one cycle. More causes a runtime
    /// exception: the script has a loop without sync(), sleep() or another call that takes time.
    std::size_t instructions_per_cycle = 100'000;
    /// Largest number of threads of the script at a time.
    std::size_t threads = 64;
    /// Largest number of calls inside each other.
    std::size_t call_depth = 200;
    /// Largest number of values in a list, with those of the lists inside it.
    std::size_t list_length = 100'000;
    /// Largest number of characters of a string or a list of strings.
    std::size_t text_length = 100'000;
};

/// Runs one program, one controller cycle after the other:
///
///     Interpreter run(*Program::parse(text), robot);
///     while (run.step() == RunState::running) { ... next cycle of the robot ... }
///
/// In each cycle every thread of the script, oldest first, runs until it calls a function that
/// takes time: sync(), sleep(), a motion, a read that has to wait, a blocking popup, join. A new
/// thread runs for the first time in the cycle in which it is started. A thread is never
/// interrupted elsewhere, so critical sections change nothing.
///
/// At the end of the program motions are abandoned; the owner closes sockets and ends force mode,
/// as the controller does.
/// Threading: one thread, which owns it. It has no threads and no clock: time is counted in cycles.
class Interpreter {
public:
    /// \param robot must outlive the interpreter
    Interpreter(Program program, Robot& robot, RunLimits limits = {});
    ~Interpreter();
    Interpreter(Interpreter&&) noexcept;
    Interpreter& operator=(Interpreter&&) noexcept;

    /// Runs one cycle. Does nothing once the program has ended. A secondary program ends in its
    /// first cycle: a call that would take time or move the arm is a runtime exception in it.
    RunState step();
    /// Ends the program from outside, for a stop button, a safety stop or another program:
    /// finished.
    void stop();

    /// State after the last cycle.
    RunState state() const;
    /// Reason of the failure; empty unless state() is failed.
    const std::optional<RuntimeException>& exception() const;
    /// Line of the main thread, from 1: RTDE's script_control_line.
    int line() const;
    /// Number of threads of the script that have not ended, with the main thread.
    std::size_t threadCount() const;
    /// Value of a variable of the program's own scope or a global one; empty if there is none.
    std::optional<Value> variable(std::string_view name) const;
    /// The program that it runs; valid as long as this.
    const Program& program() const;

private:
    class Run;
    std::unique_ptr<Run> run_;
};

}  // namespace metier::urscript
