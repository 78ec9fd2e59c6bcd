#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "builtin.hpp"
#include "metier/base/error.hpp"
#include "metier/urscript/interpreter.hpp"
#include "metier/urscript/robot.hpp"

namespace metier::urscript {

/// Asked once per cycle whether what a thread waits for has come: the value, or empty.
using Wait = std::function<Result<std::optional<Value>>()>;

/// Access of calls to the program that makes them.
class CallContext {
public:
    virtual ~CallContext() = default;
    virtual Robot& robot() = 0;
    virtual const RunLimits& limits() const = 0;
    /// A number of the program's own random numbers, 0 to 1.
    virtual double random() = 0;
    /// Errors: invalid_state if another thread moves the arm, or the program may not.
    virtual Result<void> beginMotion(const Motion& motion) = 0;
    virtual Result<bool> motionDone() = 0;
};

/// One call of a builtin. The first argument of a wrong type fails the call; later reads return
/// empty values, so a function reads all its arguments, then checks ok() before it does something.
class Call {
public:
    Call(const Builtin& builtin, std::span<const Value> arguments, CallContext& context)
        : builtin_(builtin), arguments_(arguments), context_(context) {}

    Robot& robot() { return context_.robot(); }
    CallContext& context() { return context_; }

    std::string_view name() const { return builtin_.name; }
    std::span<const Value> arguments() const { return arguments_; }
    bool given(std::size_t index) const { return !arguments_[index].isNone(); }
    const Value& value(std::size_t index) const { return arguments_[index]; }
    double number(std::size_t index);
    double number(std::size_t index, double otherwise);
    /// Also of a float, whose fraction is dropped.
    int integer(std::size_t index);
    int integer(std::size_t index, int otherwise);
    bool boolean(std::size_t index);
    bool boolean(std::size_t index, bool otherwise);
    std::string string(std::size_t index);
    std::string string(std::size_t index, std::string_view otherwise);
    List list(std::size_t index);
    Pose pose(std::size_t index);
    Vector3 vector3(std::size_t index);  ///< a list of 3 numbers
    Vector6 vector6(std::size_t index);  ///< a list of 6 numbers, or a pose
    Target target(std::size_t index);    ///< a list of 6 numbers is a joint position

    bool ok() const { return !error_; }
    const std::optional<Error>& error() const { return error_; }
    /// The call fails. Returns what its function may return.
    Value failed(Error error);
    Value failed(Errc code, std::string_view why);
    /// Value of a Result from the robot; an error fails the call.
    template <typename T>
    Value checked(Result<T> result) {
        return result ? Value(*std::move(result)) : failed(std::move(result.error()));
    }
    Value checked(Result<void> result) {
        return result ? Value() : failed(std::move(result.error()));
    }

    /// The thread waits: from the next cycle on, `wait` is asked.
    Value waits(Wait wait);
    /// The thread waits for at least one, and as many cycles as `duration` [s] has.
    Value sleeps(double duration);
    /// The thread waits until the motion is done.
    Value moves(const Motion& motion);
    Value applies(const Command& command);
    Wait takeWait() { return std::move(wait_); }

private:
    template <typename T>
    T as(std::size_t index, std::string_view wanted);
    template <std::size_t n>
    std::array<double, n> numbers(std::size_t index);
    Value wrongType(std::size_t index, std::string_view wanted);

    const Builtin& builtin_;
    std::span<const Value> arguments_;
    CallContext& context_;
    std::optional<Error> error_;
    Wait wait_;
};

/// Cycles that last at least `duration` [s]; at least 1.
std::int64_t cyclesOf(double duration, double step_time);

}  // namespace metier::urscript
