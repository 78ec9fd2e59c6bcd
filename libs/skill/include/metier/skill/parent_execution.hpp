#pragma once

#include <string>

namespace metier::skill {

/// The execution that has started another one, as it says itself.
struct ParentExecution {
    std::string id{};      ///< empty: a client did
    std::string server{};  ///< ApplicationUri; empty: of the same server
};

/// An execution that another one has started.
struct StartedExecution {
    std::string id{};
    std::string skill{};       ///< BrowseName
    std::string server_url{};  ///< empty: of the same server
};

}  // namespace metier::skill
