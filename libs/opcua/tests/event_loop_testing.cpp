#include "event_loop_testing.hpp"

#include <open62541/client_highlevel_async.h>
#include <open62541/plugin/log_stdout.h>

#include <stdexcept>

namespace metier::opcua::testing {

namespace {

const UA_NodeId kEcho{1, UA_NODEIDTYPE_NUMERIC, {62001}};
const UA_NodeId kFire{1, UA_NODEIDTYPE_NUMERIC, {62002}};
const UA_NodeId kServerObject{0, UA_NODEIDTYPE_NUMERIC, {UA_NS0ID_SERVER}};
const UA_NodeId kObjects{0, UA_NODEIDTYPE_NUMERIC, {UA_NS0ID_OBJECTSFOLDER}};

UA_String view(const std::string& text) {
    return {text.size(), reinterpret_cast<UA_Byte*>(const_cast<char*>(text.data()))};  // NOLINT
}

}  // namespace

struct TestServerCallbacks {
    static UA_StatusCode echo(UA_Server*, const UA_NodeId*, void*, const UA_NodeId*, void* context,
                              const UA_NodeId*, void*, size_t, const UA_Variant* input, size_t,
                              UA_Variant* output) {
        auto& self = *static_cast<TestServer*>(context);
        self.last_caller_ = self.loop_ ? self.loop_->currentConnection() : 0;
        return UA_Variant_copy(&input[0], &output[0]);
    }
    static UA_StatusCode fire(UA_Server*, const UA_NodeId*, void*, const UA_NodeId*, void* context,
                              const UA_NodeId*, void*, size_t, const UA_Variant*, size_t,
                              UA_Variant*) {
        static_cast<TestServer*>(context)->fire();
        return UA_STATUSCODE_GOOD;
    }
    static void itemRegistered(UA_Server* server, const UA_NodeId*, void*, const UA_NodeId*, void*,
                               UA_UInt32 attribute, UA_Boolean removed) {
        auto& self = *static_cast<TestServer*>(UA_Server_getConfig(server)->context);
        if (attribute == UA_ATTRIBUTEID_EVENTNOTIFIER && !removed && self.loop_) {
            self.event_connections_.insert(self.loop_->currentConnection());
        }
    }

    static void addMethods(UA_Server* server, TestServer* self) {
        UA_Argument text;
        UA_Argument_init(&text);
        text.dataType = UA_TYPES[UA_TYPES_STRING].typeId;
        text.valueRank = UA_VALUERANK_SCALAR;
        auto attributes = UA_MethodAttributes_default;
        attributes.executable = true;
        attributes.userExecutable = true;
        const UA_NodeId component{0, UA_NODEIDTYPE_NUMERIC, {UA_NS0ID_HASCOMPONENT}};
        UA_Server_addMethodNode(server, kEcho, kObjects, component, {1, UA_STRING_STATIC("echo")},
                                attributes, echo, 1, &text, 1, &text, self, nullptr);
        UA_Server_addMethodNode(server, kFire, kObjects, component, {1, UA_STRING_STATIC("fire")},
                                attributes, fire, 0, nullptr, 0, nullptr, self, nullptr);
        UA_Server_setNodeContext(server, kFire, self);
        UA_Server_setNodeContext(server, kEcho, self);
    }
};

TestServer::TestServer(Options options) {
    static const UA_Logger silent = UA_Log_Stdout_withLevel(UA_LOGLEVEL_FATAL);
    UA_ServerConfig config{};
    config.logging = const_cast<UA_Logger*>(&silent);  // NOLINT: the stack does not change it
    if (options.kind == LoopKind::ours) {
        options.loop.logger = &silent;
        loop_ = std::make_unique<AsioEventLoop>(options.loop);
        config.eventLoop = loop_->handle();
    }
    UA_ServerConfig_setMinimal(&config, options.port, nullptr);
    const auto url = "opc.tcp://" + options.host + ":" + std::to_string(options.port);
    UA_String_clear(&config.serverUrls[0]);
    config.serverUrls[0] = UA_String_fromChars(url.c_str());
    config.context = this;
    config.publishingIntervalLimits.min = 1;
    config.lifeTimeCountLimits.min = 3;
    config.monitoredItemRegisterCallback = TestServerCallbacks::itemRegistered;
    server_ = UA_Server_newWithConfig(&config);
    TestServerCallbacks::addMethods(server_, this);
    started_ = UA_Server_run_startup(server_);
    if (loop_ && !loop_->listening().empty()) {
        port_ = loop_->listening().front().port;
    } else {
        port_ = options.port;
    }
    if (started_ == UA_STATUSCODE_GOOD) {
        thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    }
}

TestServer::~TestServer() {
    if (thread_.joinable()) {
        thread_.request_stop();
        if (loop_) {
            loop_->post([] {});
        }
        thread_.join();
        UA_Server_run_shutdown(server_);
    }
    UA_Server_delete(server_);
}

std::string TestServer::url() const {
    return "opc.tcp://127.0.0.1:" + std::to_string(port_);
}

void TestServer::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        UA_Server_run_iterate(server_, true);
    }
}

void TestServer::fire() {
    UA_NodeId event = UA_NODEID_NULL;
    const UA_NodeId base{0, UA_NODEIDTYPE_NUMERIC, {UA_NS0ID_BASEEVENTTYPE}};
    UA_Server_createEvent(server_, base, &event);
    UA_Server_triggerEvent(server_, event, kServerObject, nullptr, true);
    flushAll();
}

void TestServer::flushAll() {
    const std::vector<ConnectionId> ids(event_connections_.begin(), event_connections_.end());
    loop_->flushPublishing(ids);
}

std::size_t subscriptionCount(UA_Server* server) {
    UA_Variant value;
    UA_Variant_init(&value);
    const UA_NodeId summary{
        0,
        UA_NODEIDTYPE_NUMERIC,
        {UA_NS0ID_SERVER_SERVERDIAGNOSTICS_SERVERDIAGNOSTICSSUMMARY_CURRENTSUBSCRIPTIONCOUNT}};
    UA_Server_readValue(server, summary, &value);
    const std::size_t count =
        value.data == nullptr ? 0 : *static_cast<const UA_UInt32*>(value.data);
    UA_Variant_clear(&value);
    return count;
}

TestClient::TestClient(LoopKind kind, EventLoopOptions options) {
    static const UA_Logger silent = UA_Log_Stdout_withLevel(UA_LOGLEVEL_FATAL);
    UA_ClientConfig config{};
    config.logging = const_cast<UA_Logger*>(&silent);  // NOLINT: the stack does not change it
    if (kind == LoopKind::ours) {
        options.logger = &silent;
        loop_ = std::make_unique<AsioEventLoop>(options);
        config.eventLoop = loop_->handle();
    }
    UA_ClientConfig_setDefault(&config);
    config.timeout = 5000;
    client_ = UA_Client_newWithConfig(&config);
}

TestClient::~TestClient() {
    UA_Client_delete(client_);
}

UA_StatusCode TestClient::connect(const std::string& url) {
    return UA_Client_connect(client_, url.c_str());
}

std::string TestClient::echo(const std::string& text) {
    auto argument = view(text);
    UA_Variant input;
    UA_Variant_setScalar(&input, &argument, &UA_TYPES[UA_TYPES_STRING]);
    size_t count = 0;
    UA_Variant* output = nullptr;
    std::string answer;
    if (UA_Client_call(client_, kObjects, kEcho, 1, &input, &count, &output) ==
        UA_STATUSCODE_GOOD) {
        const auto* value = static_cast<const UA_String*>(output[0].data);
        answer.assign(value->data, value->data + value->length);
    }
    UA_Array_delete(output, count, &UA_TYPES[UA_TYPES_VARIANT]);
    return answer;
}

void TestClient::askForEcho(const std::string& text) {
    auto argument = view(text);
    UA_Variant input;
    UA_Variant_setScalar(&input, &argument, &UA_TYPES[UA_TYPES_STRING]);
    UA_Client_call_async(client_, kObjects, kEcho, 1, &input, nullptr, nullptr, nullptr);
}

bool TestClient::fire() {
    return UA_Client_call(client_, kObjects, kFire, 0, nullptr, nullptr, nullptr) ==
           UA_STATUSCODE_GOOD;
}

UA_UInt32 TestClient::subscribe(SubscriptionOptions options) {
    auto request = UA_CreateSubscriptionRequest_default();
    request.requestedPublishingInterval = options.publishing_interval_ms;
    request.requestedLifetimeCount = options.lifetime_count;
    request.requestedMaxKeepAliveCount = options.keep_alive_count;
    const auto deleted = [](UA_Client*, UA_UInt32, void* self) {
        ++static_cast<TestClient*>(self)->deleted_;
    };
    const auto response = UA_Client_Subscriptions_create(client_, request, this, nullptr, deleted);
    if (response.responseHeader.serviceResult != UA_STATUSCODE_GOOD) {
        throw std::runtime_error("no subscription");
    }
    if (!options.events) {
        return response.subscriptionId;
    }
    UA_QualifiedName name{0, UA_STRING_STATIC("EventId")};
    UA_SimpleAttributeOperand operand;
    UA_SimpleAttributeOperand_init(&operand);
    operand.typeDefinitionId = {0, UA_NODEIDTYPE_NUMERIC, {UA_NS0ID_BASEEVENTTYPE}};
    operand.browsePathSize = 1;
    operand.browsePath = &name;
    operand.attributeId = UA_ATTRIBUTEID_VALUE;
    UA_EventFilter filter;
    UA_EventFilter_init(&filter);
    filter.selectClausesSize = 1;
    filter.selectClauses = &operand;
    UA_MonitoredItemCreateRequest item;
    UA_MonitoredItemCreateRequest_init(&item);
    item.itemToMonitor.nodeId = kServerObject;
    item.itemToMonitor.attributeId = UA_ATTRIBUTEID_EVENTNOTIFIER;
    item.monitoringMode = UA_MONITORINGMODE_REPORTING;
    item.requestedParameters.queueSize = 1000;
    UA_ExtensionObject_setValueNoDelete(&item.requestedParameters.filter, &filter,
                                        &UA_TYPES[UA_TYPES_EVENTFILTER]);
    const auto arrived = [](UA_Client*, UA_UInt32, void* self, UA_UInt32, void*, size_t,
                            UA_Variant*) {
        static_cast<TestClient*>(self)->events_.push_back(std::chrono::steady_clock::now());
    };
    const auto result = UA_Client_MonitoredItems_createEvent(
        client_, response.subscriptionId, UA_TIMESTAMPSTORETURN_BOTH, item, this, arrived, nullptr);
    if (result.statusCode != UA_STATUSCODE_GOOD) {
        throw std::runtime_error("no event item");
    }
    return response.subscriptionId;
}

bool TestClient::runUntil(const std::function<bool()>& done) {
    const auto deadline = std::chrono::steady_clock::now() + kDeadline;
    while (!done()) {
        if (std::chrono::steady_clock::now() > deadline) {
            return false;
        }
        UA_Client_run_iterate(client_, 10);
    }
    return true;
}

}  // namespace metier::opcua::testing
