#include "bare_client.hpp"

#include <open62541/client_config_default.h>
#include <open62541/client_highlevel.h>
#include <open62541/client_subscriptions.h>
#include <spdlog/sinks/null_sink.h>

#include <stdexcept>

#include "common/convert.hpp"

namespace metier::opcua::testing {

namespace {

void ignoreLog(void* /*context*/, UA_LogLevel /*level*/, UA_LogCategory /*category*/,
               const char* /*text*/, va_list /*arguments*/) {}

UA_Logger kSilent{ignoreLog, nullptr, nullptr};

void eventArrived(UA_Client* /*client*/, UA_UInt32 /*subscription*/, void* /*context*/,
                  UA_UInt32 /*item*/, void* context, std::size_t size, UA_Variant* fields) {
    ReceivedEvent event;
    for (std::size_t i = 0; i < size; ++i) {
        event.push_back(ValueAccess::copyOf(fields[i]));
    }
    static_cast<std::vector<ReceivedEvent>*>(context)->push_back(std::move(event));
}

void valueArrived(UA_Client* /*client*/, UA_UInt32 /*subscription*/, void* /*context*/,
                  UA_UInt32 /*item*/, void* context, UA_DataValue* value) {
    static_cast<std::vector<DataValue>*>(context)->push_back(fromNative(*value));
}

BareClient::FilterResult resultOf(const UA_MonitoredItemCreateResult& result) {
    BareClient::FilterResult answer{StatusCode(result.statusCode), {}, result.monitoredItemId};
    const auto* details =
        decodedAs<UA_EventFilterResult>(result.filterResult, UA_TYPES[UA_TYPES_EVENTFILTERRESULT]);
    for (std::size_t i = 0; details != nullptr && i < details->selectClauseResultsSize; ++i) {
        answer.clauses.emplace_back(details->selectClauseResults[i]);
    }
    return answer;
}

}  // namespace

BareClient::BareClient() {
    UA_ClientConfig config{};
    config.logging = &kSilent;
    UA_ClientConfig_setDefault(&config);
    config.requestedSessionTimeout = 10'000;
    UA_LocalizedText_clear(&config.clientDescription.applicationName);
    config.clientDescription.applicationName = UA_LOCALIZEDTEXT_ALLOC("", "bare client");
    client_ = UA_Client_newWithConfig(&config);
}

BareClient::~BareClient() {
    UA_Client_delete(client_);
}

StatusCode BareClient::connect(const std::string& url) {
    return StatusCode(UA_Client_connect(client_, url.c_str()));
}

StatusCode BareClient::connectAs(const std::string& user, const std::string& password,
                                 const std::string& url) {
    return StatusCode(
        UA_Client_connectUsername(client_, url.c_str(), user.c_str(), password.c_str()));
}

void BareClient::disconnect() {
    UA_Client_disconnect(client_);
}

void BareClient::breakConnection() {
    UA_Client_disconnectSecureChannel(client_);
}

StatusCode BareClient::closeSessionWithoutSubscriptions() {
    UA_CloseSessionRequest request{};
    Owned<UA_CloseSessionResponse> response(UA_TYPES[UA_TYPES_CLOSESESSIONRESPONSE]);
    __UA_Client_Service(client_, &request, &UA_TYPES[UA_TYPES_CLOSESESSIONREQUEST], response.get(),
                        &UA_TYPES[UA_TYPES_CLOSESESSIONRESPONSE]);
    return StatusCode(response->responseHeader.serviceResult);
}

StatusCode BareClient::takeSubscriptionOf(const BareClient& other) {
    auto id = other.subscription_;
    UA_TransferSubscriptionsRequest request{};
    request.subscriptionIdsSize = 1;
    request.subscriptionIds = &id;
    request.sendInitialValues = true;
    Owned<UA_TransferSubscriptionsResponse> response(
        UA_TYPES[UA_TYPES_TRANSFERSUBSCRIPTIONSRESPONSE]);
    __UA_Client_Service(client_, &request, &UA_TYPES[UA_TYPES_TRANSFERSUBSCRIPTIONSREQUEST],
                        response.get(), &UA_TYPES[UA_TYPES_TRANSFERSUBSCRIPTIONSRESPONSE]);
    return StatusCode(response->resultsSize == 1 ? response->results[0].statusCode
                                                 : response->responseHeader.serviceResult);
}

DataValue BareClient::read(const NodeId& variable) {
    return readAttribute(variable, UA_ATTRIBUTEID_VALUE);
}

DataValue BareClient::readAttribute(const NodeId& node, std::uint32_t attribute) {
    UA_ReadValueId item{};
    item.nodeId = viewOf(node);
    item.attributeId = attribute;
    UA_ReadRequest request{};
    request.nodesToRead = &item;
    request.nodesToReadSize = 1;
    request.timestampsToReturn = UA_TIMESTAMPSTORETURN_BOTH;
    Owned<UA_ReadResponse> response(UA_Client_Service_read(client_, request),
                                    UA_TYPES[UA_TYPES_READRESPONSE]);
    if (response->resultsSize != 1) {
        return {Value(), StatusCode(response->responseHeader.serviceResult), {}, {}};
    }
    return fromNative(response->results[0]);
}

std::optional<bool> BareClient::readExecutable(const NodeId& method) {
    UA_Boolean executable = false;
    const auto code = UA_Client_readExecutableAttribute(client_, viewOf(method), &executable);
    return code == UA_STATUSCODE_GOOD ? std::optional(executable) : std::nullopt;
}

std::optional<bool> BareClient::readUserExecutable(const NodeId& method) {
    UA_Boolean executable = false;
    const auto code = UA_Client_readUserExecutableAttribute(client_, viewOf(method), &executable);
    return code == UA_STATUSCODE_GOOD ? std::optional(executable) : std::nullopt;
}

StatusCode BareClient::write(const NodeId& variable, const Value& value) {
    return StatusCode(
        UA_Client_writeValueAttribute(client_, viewOf(variable), &ValueAccess::native(value)));
}

StatusCode BareClient::writeItem(const NodeId& variable, UA_WriteValue item) {
    item.nodeId = viewOf(variable);
    item.attributeId = UA_ATTRIBUTEID_VALUE;
    item.value.hasValue = true;
    UA_WriteRequest request{};
    request.nodesToWrite = &item;
    request.nodesToWriteSize = 1;
    Owned<UA_WriteResponse> response(UA_Client_Service_write(client_, request),
                                     UA_TYPES[UA_TYPES_WRITERESPONSE]);
    return StatusCode(response->resultsSize == 1 ? response->results[0]
                                                 : response->responseHeader.serviceResult);
}

StatusCode BareClient::writeWithStatus(const NodeId& variable, const Value& value,
                                       StatusCode quality) {
    UA_WriteValue item{};
    item.value.value = ValueAccess::native(value);
    item.value.hasStatus = true;
    item.value.status = quality.value();
    return writeItem(variable, item);
}

StatusCode BareClient::writeWithTime(const NodeId& variable, const Value& value, UtcTime source,
                                     UtcTime server) {
    UA_WriteValue item{};
    item.value.value = ValueAccess::native(value);
    item.value.hasSourceTimestamp = source != UtcTime{};
    item.value.sourceTimestamp = nativeTime(source);
    item.value.hasServerTimestamp = server != UtcTime{};
    item.value.serverTimestamp = nativeTime(server);
    return writeItem(variable, item);
}

StatusCode BareClient::writePart(const NodeId& variable, const Value& value,
                                 const std::string& range) {
    UA_WriteValue item{};
    item.value.value = ValueAccess::native(value);
    item.indexRange = viewOf(range);
    return writeItem(variable, item);
}

StatusCode BareClient::writeArray(const NodeId& variable, std::size_t length,
                                  std::vector<std::uint32_t> dimensions) {
    std::vector<double> zeros(length);
    UA_WriteValue item{};
    auto& value = item.value.value;
    value.type = &UA_TYPES[UA_TYPES_DOUBLE];
    value.data = zeros.empty() ? UA_EMPTY_ARRAY_SENTINEL : zeros.data();
    value.arrayLength = zeros.size();
    value.arrayDimensions = dimensions.data();
    value.arrayDimensionsSize = dimensions.size();
    return writeItem(variable, item);
}

BareClient::CallResult BareClient::call(const NodeId& object, const NodeId& method,
                                        const std::vector<Value>& inputs) {
    std::vector<UA_Variant> arguments;
    for (const auto& input : inputs) {
        arguments.push_back(ValueAccess::native(input));
    }
    std::size_t size = 0;
    UA_Variant* outputs = nullptr;
    CallResult result;
    result.status = StatusCode(UA_Client_call(client_, viewOf(object), viewOf(method),
                                              arguments.size(), arguments.data(), &size, &outputs));
    for (std::size_t i = 0; i < size; ++i) {
        result.outputs.push_back(ValueAccess::copyOf(outputs[i]));
    }
    UA_Array_delete(outputs, size, &UA_TYPES[UA_TYPES_VARIANT]);
    return result;
}

StatusCode BareClient::addFolder(const NodeId& parent) {
    return StatusCode(
        UA_Client_addObjectNode(client_, UA_NODEID_NULL, viewOf(parent), viewOf(ids::kOrganizes),
                                UA_QualifiedName{1, viewOf("intruder")}, viewOf(ids::kFolderType),
                                UA_ObjectAttributes_default, nullptr));
}

double BareClient::subscribe(double publishing_interval_ms) {
    auto request = UA_CreateSubscriptionRequest_default();
    request.requestedPublishingInterval = publishing_interval_ms;
    request.maxNotificationsPerPublish = 0;
    const auto response =
        UA_Client_Subscriptions_create(client_, request, nullptr, nullptr, nullptr);
    subscription_ = response.subscriptionId;
    return response.responseHeader.serviceResult == UA_STATUSCODE_GOOD
               ? response.revisedPublishingInterval
               : 0.0;
}

StatusCode BareClient::watchEvents(const NodeId& notifier, const std::vector<BrowsePath>& fields,
                                   std::vector<ReceivedEvent>& into) {
    BareFilter filter;
    for (const auto& path : fields) {
        filter.select({ids::kBaseEventType, path});
    }
    return watchEvents(notifier, filter, into).status;
}

BareClient::FilterResult BareClient::watchEvents(const NodeId& notifier, BareFilter& filter,
                                                 std::vector<ReceivedEvent>& into) {
    UA_MonitoredItemCreateRequest item{};
    item.itemToMonitor.nodeId = viewOf(notifier);
    item.itemToMonitor.attributeId = UA_ATTRIBUTEID_EVENTNOTIFIER;
    item.monitoringMode = UA_MONITORINGMODE_REPORTING;
    item.requestedParameters.queueSize = 10'000;
    item.requestedParameters.discardOldest = true;
    UA_ExtensionObject_setValueNoDelete(&item.requestedParameters.filter, &filter.native(),
                                        &UA_TYPES[UA_TYPES_EVENTFILTER]);
    Owned<UA_MonitoredItemCreateResult> result(
        UA_Client_MonitoredItems_createEvent(client_, subscription_, UA_TIMESTAMPSTORETURN_BOTH,
                                             item, &into, eventArrived, nullptr),
        UA_TYPES[UA_TYPES_MONITOREDITEMCREATERESULT]);
    return resultOf(*result);
}

StatusCode BareClient::watchValue(const NodeId& variable, double sampling_ms,
                                  std::vector<DataValue>& into) {
    return watchAttribute(variable, UA_ATTRIBUTEID_VALUE, sampling_ms, into);
}

StatusCode BareClient::watchAttribute(const NodeId& node, std::uint32_t attribute,
                                      double sampling_ms, std::vector<DataValue>& into) {
    auto item = UA_MonitoredItemCreateRequest_default(viewOf(node));
    item.itemToMonitor.attributeId = attribute;
    item.requestedParameters.samplingInterval = sampling_ms;
    item.requestedParameters.queueSize = 100;
    Owned<UA_MonitoredItemCreateResult> result(
        UA_Client_MonitoredItems_createDataChange(
            client_, subscription_, UA_TIMESTAMPSTORETURN_BOTH, item, &into, valueArrived, nullptr),
        UA_TYPES[UA_TYPES_MONITOREDITEMCREATERESULT]);
    return StatusCode(result->statusCode);
}

bool BareClient::runUntil(const std::function<bool()>& done, std::chrono::milliseconds deadline) {
    const auto end = std::chrono::steady_clock::now() + deadline;
    while (!done() && std::chrono::steady_clock::now() < end) {
        UA_Client_run_iterate(client_, 1);
    }
    return done();
}

ServerOptions testOptions() {
    ServerOptions options;
    options.application_uri = "urn:metier:test";
    options.port = 0;
    options.namespaces = {"urn:metier:test:a", "urn:metier:test:b"};
    options.logger =
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::null_sink_mt>());
    return options;
}

std::unique_ptr<Server> makeServer(const ServerOptions& options) {
    auto server = Server::create(options);
    if (!server) {
        throw std::runtime_error(server.error().message);
    }
    return std::move(*server);
}

}  // namespace metier::opcua::testing
