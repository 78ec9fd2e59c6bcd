#pragma once

#include <open62541/server.h>

#include <array>

#include "metier/base/error.hpp"

namespace metier::opcua {

/// The Methods of the stack that sessions may call: they read or change only subscriptions of the
/// calling session. All others are closed to everybody, among them those that would add and delete
/// nodes.
///
/// The stack (1.4) takes an empty array for a value where a scalar is expected, and reads beyond
/// it: these Methods get only scalars.
/// Threading: the server's thread.
class StackMethods {
public:
    static bool isOfOwnSession(const UA_NodeId& method) noexcept;

    /// Stands in front of them.
    /// Errors: internal (the stack has them not).
    Result<> guard(UA_Server* server);

private:
    static constexpr std::array kIds{UA_NS0ID_SERVER_GETMONITOREDITEMS, UA_NS0ID_SERVER_RESENDDATA};

    struct Callbacks;
    std::array<UA_MethodCallback, kIds.size()> behind_{};
};

}  // namespace metier::opcua
