#pragma once

#include <open62541/types_generated.h>

#include <cstddef>
#include <functional>

#include "metier/opcua/answer.hpp"

namespace metier::opcua {

/// For each request of the stack, its response and where both are in UA_TYPES.
template <typename Request>
struct Service;

#define METIER_SERVICE(Name, NAME)                                          \
    template <>                                                             \
    struct Service<UA_##Name##Request> {                                    \
        using Response = UA_##Name##Response;                               \
        static constexpr std::size_t kRequest = UA_TYPES_##NAME##REQUEST;   \
        static constexpr std::size_t kResponse = UA_TYPES_##NAME##RESPONSE; \
    };

METIER_SERVICE(Read, READ)
METIER_SERVICE(Write, WRITE)
METIER_SERVICE(Call, CALL)
METIER_SERVICE(Browse, BROWSE)
METIER_SERVICE(BrowseNext, BROWSENEXT)
METIER_SERVICE(TranslateBrowsePathsToNodeIds, TRANSLATEBROWSEPATHSTONODEIDS)
METIER_SERVICE(CreateSubscription, CREATESUBSCRIPTION)
METIER_SERVICE(CreateMonitoredItems, CREATEMONITOREDITEMS)
METIER_SERVICE(DeleteMonitoredItems, DELETEMONITOREDITEMS)
METIER_SERVICE(Publish, PUBLISH)
METIER_SERVICE(GetEndpoints, GETENDPOINTS)
METIER_SERVICE(FindServers, FINDSERVERS)
METIER_SERVICE(RegisterServer, REGISTERSERVER)
METIER_SERVICE(RegisterServer2, REGISTERSERVER2)

#undef METIER_SERVICE

/// Receives the response to a request; the pointer is valid only during the call.
template <typename Request>
using OnResponse = std::function<void(Answer<typename Service<Request>::Response*>)>;

}  // namespace metier::opcua
