#pragma once

#include <span>
#include <string>
#include <string_view>

namespace metier::cell {

/// A kind of limit that a cell file may set for the demands of clients on a server.
struct LimitKind {
    /// Its key in the file, the same as in opcua::ServerLimits.
    std::string_view name;
    /// Unit of its values: "byte", "s", or the counted thing.
    std::string_view unit;
    /// Smallest value that a file may set, in `unit`.
    double least;
    /// Largest value that a file may set, in `unit`.
    double most;
    /// Whether it is a whole number; otherwise a time.
    bool whole;
};

/// All kinds of limits. The span is valid as long as the program runs.
/// Threads: any.
std::span<const LimitKind> limitKinds() noexcept;

/// A limit that a cell file sets.
struct Limit {
    /// Name of a LimitKind.
    std::string name;
    /// Value in the unit and within the bounds of the LimitKind.
    double value = 0.0;
};

}  // namespace metier::cell
