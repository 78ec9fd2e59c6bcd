#pragma once

#include <open62541/server.h>

#include <array>

#include "metier/base/error.hpp"

namespace metier::opcua {

/// The Methods of the stack that sessions may call: they tell of, or change, only what the own
/// session has subscribed. All others are closed to everybody, among them those that would add and
/// delete nodes.
///
/// The stack takes an empty array for a value where a scalar is asked for, and reads what is not
/// there: these Methods get scalars alone.
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
