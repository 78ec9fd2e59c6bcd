#include "bare.hpp"

#include <fmt/format.h>
#include <open62541/client_config_default.h>
#include <open62541/client_highlevel.h>
#include <open62541/client_subscriptions.h>
#include <open62541/plugin/log_stdout.h>
#include <open62541/server.h>
#include <open62541/server_config_default.h>

#include <array>
#include <atomic>
#include <stdexcept>
#include <thread>

namespace metier::opcua::bare {
namespace {

constexpr UA_UInt16 kPort = 48999;
constexpr UA_UInt32 kProgram = 100'000;  // ids of our own nodes, namespace 1
constexpr UA_UInt32 kNothing = 100'001;
constexpr UA_UInt32 kStart = 100'002;
constexpr UA_UInt32 kFirstProgram = 200'000;
constexpr UA_UInt32 kNodesOfProgram = 40;
constexpr UA_UInt32 kMethods = 3;  // of each Program, then its parameters
constexpr UA_UInt16 kSeverity = 300;

UA_NodeId own(UA_UInt32 id) {
    return UA_NODEID_NUMERIC(1, id);
}
UA_NodeId standard(UA_UInt32 id) {
    return UA_NODEID_NUMERIC(0, id);
}

void require(UA_StatusCode status, const char* what) {
    if (status != UA_STATUSCODE_GOOD) {
        throw std::runtime_error(fmt::format("{}: {}", what, UA_StatusCode_name(status)));
    }
}

struct ParsedId {
    explicit ParsedId(const std::string& text) {
        const auto ascii = UA_STRING(const_cast<char*>(text.c_str()));  // NOLINT: only read
        require(UA_NodeId_parse(&id, ascii), "parsing a NodeId");
    }
    ~ParsedId() { UA_NodeId_clear(&id); }
    ParsedId(const ParsedId&) = delete;
    ParsedId& operator=(const ParsedId&) = delete;

    UA_NodeId id{};
};

UA_QualifiedName name(const std::string& text) {
    return UA_QUALIFIEDNAME(1, const_cast<char*>(text.c_str()));  // NOLINT: the stack copies it
}

void raiseEvent(UA_Server* server) {
    UA_NodeId event;
    require(UA_Server_createEvent(server, standard(UA_NS0ID_PROGRAMTRANSITIONEVENTTYPE), &event),
            "createEvent");
    UA_DateTime now = UA_DateTime_now();
    UA_UInt16 severity = kSeverity;
    UA_Server_writeObjectProperty_scalar(server, event,
                                         UA_QUALIFIEDNAME(0, const_cast<char*>("Time")), &now,
                                         &UA_TYPES[UA_TYPES_DATETIME]);
    UA_Server_writeObjectProperty_scalar(server, event,
                                         UA_QUALIFIEDNAME(0, const_cast<char*>("Severity")),
                                         &severity, &UA_TYPES[UA_TYPES_UINT16]);
    require(UA_Server_triggerEvent(server, event, own(kProgram), nullptr, true), "triggerEvent");
}

UA_StatusCode nothing(UA_Server*, const UA_NodeId*, void*, const UA_NodeId*, void*,
                      const UA_NodeId*, void*, size_t, const UA_Variant*, size_t, UA_Variant*) {
    return UA_STATUSCODE_GOOD;
}

UA_StatusCode startProgram(UA_Server* server, const UA_NodeId*, void*, const UA_NodeId*, void*,
                           const UA_NodeId*, void*, size_t, const UA_Variant*, size_t,
                           UA_Variant*) {
    raiseEvent(server);
    raiseEvent(server);
    return UA_STATUSCODE_GOOD;
}

void addMethod(UA_Server* server, UA_UInt32 parent, UA_UInt32 id, UA_MethodCallback callback) {
    UA_MethodAttributes attributes = UA_MethodAttributes_default;
    attributes.executable = true;
    attributes.userExecutable = true;
    const auto text = fmt::format("Method{}", id);
    require(UA_Server_addMethodNode(server, own(id), own(parent), standard(UA_NS0ID_HASCOMPONENT),
                                    name(text), attributes, callback, 0, nullptr, 0, nullptr,
                                    nullptr, nullptr),
            "addMethodNode");
}

void addProgram(UA_Server* server, UA_UInt32 id) {
    UA_ObjectAttributes attributes = UA_ObjectAttributes_default;
    attributes.eventNotifier = 1;
    const auto text = fmt::format("Program{}", id);
    require(UA_Server_addObjectNode(server, own(id), standard(UA_NS0ID_OBJECTSFOLDER),
                                    standard(UA_NS0ID_ORGANIZES), name(text),
                                    standard(UA_NS0ID_PROGRAMSTATEMACHINETYPE), attributes, nullptr,
                                    nullptr),
            "addObjectNode");
}

void addParameter(UA_Server* server, UA_UInt32 parent, UA_UInt32 id) {
    UA_VariableAttributes attributes = UA_VariableAttributes_default;
    UA_Double value = 0;
    UA_Variant_setScalar(&attributes.value, &value, &UA_TYPES[UA_TYPES_DOUBLE]);
    attributes.dataType = UA_TYPES[UA_TYPES_DOUBLE].typeId;
    attributes.accessLevel = UA_ACCESSLEVELMASK_READ | UA_ACCESSLEVELMASK_WRITE;
    const auto text = fmt::format("Parameter{}", id);
    require(UA_Server_addVariableNode(server, own(id), own(parent), standard(UA_NS0ID_HASCOMPONENT),
                                      name(text), standard(UA_NS0ID_BASEDATAVARIABLETYPE),
                                      attributes, nullptr, nullptr),
            "addVariableNode");
}

}  // namespace

struct Server::Impl {
    UA_Server* server = UA_Server_new();
    std::atomic<bool> running{true};
    std::jthread thread;
};

Server::Server() : impl_(std::make_unique<Impl>()) {
    auto* config = UA_Server_getConfig(impl_->server);
    *config->logging = UA_Log_Stdout_withLevel(UA_LOGLEVEL_ERROR);
    require(UA_ServerConfig_setMinimal(config, kPort, nullptr), "setMinimal");
    addProgram(impl_->server, kProgram);
    addMethod(impl_->server, kProgram, kNothing, nothing);
    addMethod(impl_->server, kProgram, kStart, startProgram);
}

Server::~Server() {
    impl_->running = false;
    impl_->thread = {};
    UA_Server_delete(impl_->server);
}

std::string Server::url() const {
    return fmt::format("opc.tcp://127.0.0.1:{}", kPort);
}

void Server::addPrograms(std::uint32_t count) {
    constexpr UA_UInt32 kParameters = 6;
    for (UA_UInt32 i = 0; i < count; ++i) {
        const UA_UInt32 id = kFirstProgram + i * kNodesOfProgram;
        addProgram(impl_->server, id);
        for (UA_UInt32 method = 1; method <= kMethods; ++method) {
            addMethod(impl_->server, id, id + method, nothing);
        }
        for (UA_UInt32 parameter = 1; parameter <= kParameters; ++parameter) {
            addParameter(impl_->server, id, id + kMethods + parameter);
        }
    }
}

void Server::start() {
    require(UA_Server_run_startup(impl_->server), "run_startup");
    impl_->thread = std::jthread([impl = impl_.get()] {
        while (impl->running) {
            UA_Server_run_iterate(impl->server, true);
        }
        UA_Server_run_shutdown(impl->server);
    });
}

struct Client::Impl {
    UA_Client* client = UA_Client_new();
    std::function<void()> on_event;

    void call(const UA_NodeId& object, const UA_NodeId& method) const {
        require(UA_Client_call(client, object, method, 0, nullptr, nullptr, nullptr), "call");
    }
};

Client::Client(const std::string& url) : impl_(std::make_unique<Impl>()) {
    auto* config = UA_Client_getConfig(impl_->client);
    *config->logging = UA_Log_Stdout_withLevel(UA_LOGLEVEL_ERROR);
    require(UA_ClientConfig_setDefault(config), "setDefault");
    require(UA_Client_connect(impl_->client, url.c_str()), "connect");
}

Client::~Client() {
    UA_Client_delete(impl_->client);
}

void Client::callNothing() {
    impl_->call(own(kProgram), own(kNothing));
}
void Client::write(const std::string& variable, double value) {
    UA_Variant variant;
    UA_Variant_setScalar(&variant, &value, &UA_TYPES[UA_TYPES_DOUBLE]);
    require(UA_Client_writeValueAttribute(impl_->client, ParsedId(variable).id, &variant), "write");
}

double Client::read(const std::string& variable) {
    UA_Variant variant;
    UA_Variant_init(&variant);
    require(UA_Client_readValueAttribute(impl_->client, ParsedId(variable).id, &variant), "read");
    const bool number = UA_Variant_hasScalarType(&variant, &UA_TYPES[UA_TYPES_DOUBLE]);
    const double value = number ? *static_cast<const double*>(variant.data) : 0.0;
    UA_Variant_clear(&variant);
    require(number ? UA_STATUSCODE_GOOD : UA_STATUSCODE_BADTYPEMISMATCH, "read");
    return value;
}

void Client::writeParameter(double value) {
    UA_Variant variant;
    UA_Variant_setScalar(&variant, &value, &UA_TYPES[UA_TYPES_DOUBLE]);
    require(
        UA_Client_writeValueAttribute(impl_->client, own(kFirstProgram + kMethods + 1), &variant),
        "write");
}
void Client::callStart() {
    impl_->call(own(kProgram), own(kStart));
}

void Client::call(const std::string& object, const std::string& method) {
    impl_->call(ParsedId(object).id, ParsedId(method).id);
}

void Client::subscribe(std::chrono::milliseconds publishing_interval,
                       std::function<void()> on_event) {
    impl_->on_event = std::move(on_event);
    auto request = UA_CreateSubscriptionRequest_default();
    request.requestedPublishingInterval = static_cast<double>(publishing_interval.count());
    const auto response =
        UA_Client_Subscriptions_create(impl_->client, request, nullptr, nullptr, nullptr);
    require(response.responseHeader.serviceResult, "createSubscription");
    UA_EventFilter filter;
    UA_EventFilter_init(&filter);
    UA_SimpleAttributeOperand operand;
    UA_SimpleAttributeOperand_init(&operand);
    UA_QualifiedName path = UA_QUALIFIEDNAME(0, const_cast<char*>("Severity"));
    operand.typeDefinitionId = standard(UA_NS0ID_BASEEVENTTYPE);
    operand.browsePathSize = 1;
    operand.browsePath = &path;
    operand.attributeId = UA_ATTRIBUTEID_VALUE;
    filter.selectClausesSize = 1;
    filter.selectClauses = &operand;
    UA_MonitoredItemCreateRequest item;
    UA_MonitoredItemCreateRequest_init(&item);
    item.itemToMonitor.nodeId = own(kProgram);
    item.itemToMonitor.attributeId = UA_ATTRIBUTEID_EVENTNOTIFIER;
    item.monitoringMode = UA_MONITORINGMODE_REPORTING;
    item.requestedParameters.queueSize = 100;
    UA_ExtensionObject_setValueNoDelete(&item.requestedParameters.filter, &filter,
                                        &UA_TYPES[UA_TYPES_EVENTFILTER]);
    const auto notify = [](UA_Client*, UA_UInt32, void*, UA_UInt32, void* context, size_t,
                           UA_Variant*) { static_cast<Impl*>(context)->on_event(); };
    const auto result = UA_Client_MonitoredItems_createEvent(impl_->client, response.subscriptionId,
                                                             UA_TIMESTAMPSTORETURN_BOTH, item,
                                                             impl_.get(), notify, nullptr);
    require(result.statusCode, "createEvent item");
}

void Client::iterate(std::chrono::milliseconds timeout) {
    require(UA_Client_run_iterate(impl_->client, static_cast<UA_UInt32>(timeout.count())),
            "iterate");
}

}  // namespace metier::opcua::bare
