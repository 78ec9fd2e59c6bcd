#pragma once

#include <string>

namespace metier::skill {

/// The execution that started another one, as the starter claims; nobody checks it.
struct ParentExecution {
    std::string id{};      ///< ExecutionId; empty: a client started it
    std::string server{};  ///< its ApplicationUri; empty: the same server
};

/// An execution that another one has started.
struct StartedExecution {
    std::string id{};          ///< ExecutionId
    std::string skill{};       ///< BrowseName
    std::string server_url{};  ///< address of its server; empty: the same server
};

}  // namespace metier::skill
