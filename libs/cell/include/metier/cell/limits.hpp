#pragma once

#include <span>
#include <string>
#include <string_view>

namespace metier::cell {

/// A kind of limit that a cell file may set for the demands of clients on a server.
struct LimitKind {
    std::string_view name;  ///< its key in the file, the same as in opcua::ServerLimits
    std::string_view unit;
    /// Smallest and largest value that a file may set, both allowed, in `unit`.
    double least;
    double most;
    bool whole;  ///< a whole number; otherwise a time
};

/// All kinds of limits. The span is valid as long as the program runs.
std::span<const LimitKind> limitKinds() noexcept;

/// A limit that a cell file sets.
struct Limit {
    std::string name;    ///< name of a LimitKind
    double value = 0.0;  ///< in the unit and within the bounds of the LimitKind
};

}  // namespace metier::cell
