#pragma once

#include <string>

namespace metier::skill {

/// The execution that started another one, as the starter claims; nobody checks it. Clients give it
/// as ParentExecution and ParentServer of StartWith.
struct ParentExecution {
    /// ExecutionId; empty: a client started it.
    std::string id{};
    /// ApplicationUri of its server; empty: the same server.
    std::string server{};
};

/// An execution that another one has started; recorded as its child.
struct StartedExecution {
    /// ExecutionId on the server that runs it.
    std::string id{};
    /// BrowseName of the skill that runs it.
    std::string skill{};
    /// Address of its server, "opc.tcp://..."; empty: the same server.
    std::string server_url{};
};

}  // namespace metier::skill
