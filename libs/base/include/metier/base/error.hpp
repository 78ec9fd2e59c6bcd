#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

namespace metier {

/// Kinds of failure, divided by what the caller can do about them. One table in libs/opcua maps
/// these to StatusCodes.
///
/// Add new kinds before `internal`: the table of names in error.cpp ends there, and its size is
/// checked at compile time.
enum class Errc {
    /// Wrong size, not finite, malformed: correct the call.
    invalid_argument,
    /// A value of another type than the parameter has.
    type_mismatch,
    /// A value beyond a stated limit: choose another one.
    out_of_range,
    /// No joint position reaches the pose within the limits.
    unreachable,
    /// The named thing does not exist.
    not_found,
    /// The name or id is taken.
    already_exists,
    /// The current state does not allow it: Reset or wait.
    invalid_state,
    /// Another client holds it: wait or ask its owner.
    locked,
    /// The device is busy with another skill, or a file, port or disk cannot be had.
    resource_unavailable,
    /// The user may not do this.
    access_denied,
    /// The deadline passed; what was asked for may still happen.
    timeout,
    /// The peer is gone: reconnect.
    connection_lost,
    /// The server has no record of the execution any more: it is over.
    execution_lost,
    /// The device refused or stopped: see its own panel.
    device_fault,
    /// A limit was exceeded during a motion.
    limit_violated,
    /// The peer or device cannot do this.
    not_supported,
    /// Ended on request.
    cancelled,
    /// A defect of this program, or an exception of a skill.
    internal,
};

/// Name of the enumerator, for logs and JSON; valid for ever. A number outside the enum gives
/// "unknown".
/// Threads: any; pure.
std::string_view toString(Errc code) noexcept;

/// A failure: `code` is for the program, `message` for the person, with value, limit and unit.
///
///     if (const auto done = arm.halt(); !done && done.error().code == Errc::connection_lost) {
///         reconnect();
///     }
struct Error {
    /// Kind of the failure.
    Errc code = Errc::internal;
    /// Text for a person: the thing, the value, the limit and the unit.
    std::string message;
};

/// A value, or the Error that explains why there is none. Reading the value of a failed one is
/// undefined: test it first:
///
///     if (const auto model = RobotModel::load(file); model) { use(*model); }
///     else { print(model.error().message); }
template <typename T = void>
using Result = tl::expected<T, Error>;

/// A failed Result: `return fail(Errc::not_found, "no axis 7");`
/// \param message one sentence without a full stop: thing, value, limit and unit
inline tl::unexpected<Error> fail(Errc code, std::string message) {
    return tl::unexpected<Error>(Error{code, std::move(message)});
}

/// A failed Result that passes on another's error: `return fail(plan.error());`
inline tl::unexpected<Error> fail(Error error) {
    return tl::unexpected<Error>(std::move(error));
}

}  // namespace metier

/// Leaves the function with the error of a Result, or goes on if it has a value:
///
///     METIER_TRY(arm.halt());
///
/// The expression is evaluated once. Works with every tl::expected, in functions that return a
/// tl::expected whose error can be constructed from that error.
#define METIER_TRY(...) METIER_TRY_AS(METIER_NEW_NAME(__COUNTER__), __VA_ARGS__)

/// Gives a variable the value of a Result, or leaves the function with its error:
///
///     METIER_ASSIGN(const auto plan, planner.plan(request));
///
/// The first argument is the left side of a declaration or an assignment, without the `=`. The
/// value is moved; if the expression is a variable, that Result is copied first. The macro is two
/// statements: it needs a block and does not compile as the only statement of an `if`.
#define METIER_ASSIGN(variable, ...) \
    METIER_ASSIGN_AS(METIER_NEW_NAME(__COUNTER__), variable, __VA_ARGS__)

// NOLINTBEGIN(bugprone-macro-parentheses): a declaration cannot be in parentheses
// Not for callers: the parts of the two macros above. __COUNTER__ gives the Result a name of its
// own, so that a function can use them several times.
#define METIER_TRY_AS(result, ...)                          \
    if (auto result = (__VA_ARGS__); !result) {             \
        return ::tl::unexpected(std::move(result).error()); \
    }                                                       \
    static_assert(true)
#define METIER_ASSIGN_AS(result, variable, ...)             \
    auto result = (__VA_ARGS__);                            \
    if (!result) {                                          \
        return ::tl::unexpected(std::move(result).error()); \
    }                                                       \
    variable = *std::move(result)
#define METIER_NEW_NAME(number) METIER_JOINED(metier_result_, number)
#define METIER_JOINED(left, right) left##right
// NOLINTEND(bugprone-macro-parentheses)
