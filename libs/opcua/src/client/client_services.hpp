#pragma once

#include <open62541/types_generated.h>

#include <cstddef>
#include <functional>

#include "metier/opcua/answer.hpp"

namespace metier::opcua {

template <typename ResponseType, std::size_t kRequestType, std::size_t kResponseType>
struct ServiceTypes {
    using Response = ResponseType;
    static constexpr std::size_t kRequest = kRequestType;
    static constexpr std::size_t kResponse = kResponseType;
};

/// For each request of the stack, its response and where both are in UA_TYPES.
template <typename Request>
struct Service;

template <>
struct Service<UA_ReadRequest>
    : ServiceTypes<UA_ReadResponse, UA_TYPES_READREQUEST, UA_TYPES_READRESPONSE> {};
template <>
struct Service<UA_WriteRequest>
    : ServiceTypes<UA_WriteResponse, UA_TYPES_WRITEREQUEST, UA_TYPES_WRITERESPONSE> {};
template <>
struct Service<UA_CallRequest>
    : ServiceTypes<UA_CallResponse, UA_TYPES_CALLREQUEST, UA_TYPES_CALLRESPONSE> {};
template <>
struct Service<UA_BrowseRequest>
    : ServiceTypes<UA_BrowseResponse, UA_TYPES_BROWSEREQUEST, UA_TYPES_BROWSERESPONSE> {};
template <>
struct Service<UA_BrowseNextRequest>
    : ServiceTypes<UA_BrowseNextResponse, UA_TYPES_BROWSENEXTREQUEST, UA_TYPES_BROWSENEXTRESPONSE> {
};
template <>
struct Service<UA_TranslateBrowsePathsToNodeIdsRequest>
    : ServiceTypes<UA_TranslateBrowsePathsToNodeIdsResponse,
                   UA_TYPES_TRANSLATEBROWSEPATHSTONODEIDSREQUEST,
                   UA_TYPES_TRANSLATEBROWSEPATHSTONODEIDSRESPONSE> {};
template <>
struct Service<UA_CreateSubscriptionRequest>
    : ServiceTypes<UA_CreateSubscriptionResponse, UA_TYPES_CREATESUBSCRIPTIONREQUEST,
                   UA_TYPES_CREATESUBSCRIPTIONRESPONSE> {};
template <>
struct Service<UA_CreateMonitoredItemsRequest>
    : ServiceTypes<UA_CreateMonitoredItemsResponse, UA_TYPES_CREATEMONITOREDITEMSREQUEST,
                   UA_TYPES_CREATEMONITOREDITEMSRESPONSE> {};
template <>
struct Service<UA_DeleteMonitoredItemsRequest>
    : ServiceTypes<UA_DeleteMonitoredItemsResponse, UA_TYPES_DELETEMONITOREDITEMSREQUEST,
                   UA_TYPES_DELETEMONITOREDITEMSRESPONSE> {};
template <>
struct Service<UA_PublishRequest>
    : ServiceTypes<UA_PublishResponse, UA_TYPES_PUBLISHREQUEST, UA_TYPES_PUBLISHRESPONSE> {};
template <>
struct Service<UA_GetEndpointsRequest>
    : ServiceTypes<UA_GetEndpointsResponse, UA_TYPES_GETENDPOINTSREQUEST,
                   UA_TYPES_GETENDPOINTSRESPONSE> {};
template <>
struct Service<UA_FindServersRequest>
    : ServiceTypes<UA_FindServersResponse, UA_TYPES_FINDSERVERSREQUEST,
                   UA_TYPES_FINDSERVERSRESPONSE> {};
template <>
struct Service<UA_RegisterServerRequest>
    : ServiceTypes<UA_RegisterServerResponse, UA_TYPES_REGISTERSERVERREQUEST,
                   UA_TYPES_REGISTERSERVERRESPONSE> {};
template <>
struct Service<UA_RegisterServer2Request>
    : ServiceTypes<UA_RegisterServer2Response, UA_TYPES_REGISTERSERVER2REQUEST,
                   UA_TYPES_REGISTERSERVER2RESPONSE> {};

/// Receives the response to a request; the pointer is valid only during the call.
template <typename Request>
using OnResponse = std::function<void(Answer<typename Service<Request>::Response*>)>;

}  // namespace metier::opcua
