#pragma once

#include <span>
#include <string>
#include <string_view>

namespace metier::cell {

/// One limit that a cell file may set for what clients ask of a server.
struct LimitKind {
    std::string_view name;  ///< its key, that of opcua::ServerLimits
    std::string_view unit;
    double least;
    double most;
    bool whole;  ///< a whole number; otherwise a time
};

/// All there are.
std::span<const LimitKind> limitKinds() noexcept;

/// A limit that a cell file sets.
struct Limit {
    std::string name;    ///< of a LimitKind
    double value = 0.0;  ///< in its unit, within its bounds
};

}  // namespace metier::cell
