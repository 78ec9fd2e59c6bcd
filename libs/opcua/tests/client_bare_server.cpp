#include "client_bare_server.hpp"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <open62541/plugin/accesscontrol_default.h>
#include <open62541/server_config_default.h>
#include <sys/socket.h>
#include <unistd.h>

#include <future>

#include "common/convert.hpp"

namespace metier::opcua::testing {

namespace {

void ignoreLog(void* /*context*/, UA_LogLevel /*level*/, UA_LogCategory /*category*/,
               const char* /*format*/, va_list /*arguments*/) {}

UA_Logger& silence() {
    static UA_Logger logger{&ignoreLog, nullptr, nullptr};
    return logger;
}

void check(UA_StatusCode code) {
    if (code != UA_STATUSCODE_GOOD) {
        throw std::runtime_error(UA_StatusCode_name(code));
    }
}

UA_StatusCode add(UA_Server* /*server*/, const UA_NodeId* /*session*/, void* /*session_context*/,
                  const UA_NodeId* /*method*/, void* /*method_context*/,
                  const UA_NodeId* /*object*/, void* /*object_context*/, size_t /*input_size*/,
                  const UA_Variant* input, size_t /*output_size*/, UA_Variant* output) {
    const auto sum =
        *static_cast<const double*>(input[0].data) + *static_cast<const double*>(input[1].data);
    return UA_Variant_setScalarCopy(output, &sum, &UA_TYPES[UA_TYPES_DOUBLE]);
}

UA_StatusCode refuse(UA_Server* /*server*/, const UA_NodeId* /*session*/, void* /*session_context*/,
                     const UA_NodeId* /*method*/, void* /*method_context*/,
                     const UA_NodeId* /*object*/, void* /*object_context*/, size_t /*input_size*/,
                     const UA_Variant* /*input*/, size_t /*output_size*/, UA_Variant* /*output*/) {
    return UA_STATUSCODE_BADINVALIDSTATE;
}

void raiseOne(UA_Server* server, const UA_NodeId& source, std::uint32_t number) {
    UA_NodeId event;
    check(UA_Server_createEvent(server, viewOf(ids::kProgramTransitionEventType), &event));
    const auto text = std::to_string(number);
    UA_LocalizedText message{UA_STRING_NULL, viewOf(std::string_view(text))};
    UA_QualifiedName name{0, viewOf(std::string_view("Message"))};
    check(UA_Server_writeObjectProperty_scalar(server, event, name, &message,
                                               &UA_TYPES[UA_TYPES_LOCALIZEDTEXT]));
    check(UA_Server_triggerEvent(server, event, source, nullptr, true));
}

UA_StatusCode raise(UA_Server* server, const UA_NodeId* /*session*/, void* /*session_context*/,
                    const UA_NodeId* /*method*/, void* /*method_context*/, const UA_NodeId* object,
                    void* /*object_context*/, size_t /*input_size*/, const UA_Variant* input,
                    size_t /*output_size*/, UA_Variant* /*output*/) {
    const auto count = *static_cast<const std::uint32_t*>(input[0].data);
    for (std::uint32_t i = 1; i <= count; ++i) {
        raiseOne(server, *object, i);
    }
    return UA_STATUSCODE_GOOD;
}

struct Place {
    NodeId parent;
    NodeId reference;
};

void addVariable(UA_Server* server, const Place& place, const NodeId& id, UA_Byte access) {
    double value = 1.5;
    auto attributes = UA_VariableAttributes_default;
    UA_Variant_setScalar(&attributes.value, &value, &UA_TYPES[UA_TYPES_DOUBLE]);
    attributes.dataType = UA_TYPES[UA_TYPES_DOUBLE].typeId;
    attributes.accessLevel = access;
    const auto& text = std::get<std::string>(id.identifier());
    check(UA_Server_addVariableNode(server, viewOf(id), viewOf(place.parent),
                                    viewOf(place.reference), {1, viewOf(std::string_view(text))},
                                    viewOf(ids::kBaseDataVariableType), attributes, nullptr,
                                    nullptr));
}

void addObject(UA_Server* server, const NodeId& id, UA_Byte event_notifier) {
    auto attributes = UA_ObjectAttributes_default;
    attributes.eventNotifier = event_notifier;
    const auto& text = std::get<std::string>(id.identifier());
    check(UA_Server_addObjectNode(server, viewOf(id), viewOf(ids::kObjectsFolder),
                                  viewOf(ids::kOrganizes), {1, viewOf(std::string_view(text))},
                                  viewOf(ids::kBaseObjectType), attributes, nullptr, nullptr));
}

struct Arguments {
    const UA_DataType& type;
    std::size_t inputs;
    std::size_t outputs;
};

void addMethod(UA_Server* server, const NodeId& id, UA_MethodCallback callback,
               Arguments arguments) {
    std::array<UA_Argument, 2> inputs{};
    std::array<UA_Argument, 1> outputs{};
    for (auto* argument : {inputs.data(), &inputs[1], outputs.data()}) {
        argument->dataType = arguments.type.typeId;
        argument->valueRank = UA_VALUERANK_SCALAR;
    }
    auto attributes = UA_MethodAttributes_default;
    attributes.executable = true;
    attributes.userExecutable = true;
    const auto& text = std::get<std::string>(id.identifier());
    check(UA_Server_addMethodNode(server, viewOf(id), viewOf(kHolder), viewOf(ids::kHasComponent),
                                  {1, viewOf(std::string_view(text))}, attributes, callback,
                                  arguments.inputs, inputs.data(), arguments.outputs,
                                  outputs.data(), nullptr, nullptr));
}

std::string urlOf(std::uint16_t port) {
    return "opc.tcp://127.0.0.1:" + std::to_string(port);
}

UA_Server* makeServer(AsioEventLoop& loop, const BareServerOptions& options) {
    UA_ServerConfig config{};
    config.logging = &silence();
    config.eventLoop = loop.handle();
    check(UA_ServerConfig_setMinimal(&config, options.port, nullptr));
    UA_UsernamePasswordLogin login{viewOf(std::string_view("user1")),
                                   viewOf(std::string_view(options.password))};
    check(UA_AccessControl_default(&config, true, nullptr, 1, &login));
    config.allowNonePolicyPassword = true;
    return UA_Server_newWithConfig(&config);
}

}  // namespace

BareServer::BareServer(const BareServerOptions& options) : server_(makeServer(loop_, options)) {
    addNodes(options);
    check(UA_Server_run_startup(server_));
    port_ = loop_.listening().front().port;
    url_ = urlOf(port_);
    thread_ = std::jthread([this](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            UA_Server_run_iterate(server_, true);
        }
    });
}

BareServer::~BareServer() {
    resume();
    thread_.request_stop();
    loop_.post([] {});
    thread_.join();
    UA_Server_run_shutdown(server_);
    UA_Server_delete(server_);
}

void BareServer::pause() {
    {
        const std::lock_guard lock(mutex_);
        paused_ = true;
    }
    auto pausing = std::make_shared<std::promise<void>>();
    loop_.post([this, pausing] {
        pausing->set_value();
        std::unique_lock lock(mutex_);
        resumed_.wait_for(lock, std::chrono::seconds(30), [this] { return !paused_; });
    });
    pausing->get_future().wait();
}

void BareServer::resume() {
    {
        const std::lock_guard lock(mutex_);
        paused_ = false;
    }
    resumed_.notify_all();
}

void BareServer::run(const std::function<void(UA_Server*)>& work) {
    std::promise<void> done;
    loop_.post([&] {
        work(server_);
        done.set_value();
    });
    done.get_future().wait();
}

void BareServer::limitQueues(std::uint32_t length) {
    run([length](UA_Server* server) {
        UA_Server_getConfig(server)->queueSizeLimits = {1, length};
    });
}

void BareServer::addNodes(const BareServerOptions& options) {
    constexpr UA_Byte kRead = UA_ACCESSLEVELMASK_READ;
    constexpr UA_Byte kReadWrite = kRead | UA_ACCESSLEVELMASK_WRITE;
    const Place objects{ids::kObjectsFolder, ids::kOrganizes};
    addVariable(server_, objects, kNumber, kReadWrite);
    addVariable(server_, objects, kReadOnly, kRead);
    addObject(server_, kHolder, 1);
    addMethod(server_, kAdd, &add, {UA_TYPES[UA_TYPES_DOUBLE], 2, 1});
    addMethod(server_, kRefuse, &refuse, {UA_TYPES[UA_TYPES_DOUBLE], 0, 0});
    addMethod(server_, kRaise, &raise, {UA_TYPES[UA_TYPES_UINT32], 1, 0});
    addObject(server_, kMany, 0);
    for (int i = 0; i < options.many; ++i) {
        addVariable(server_, {kMany, ids::kHasComponent}, {1, std::to_string(i)}, kRead);
    }
    for (int i = 0; i < options.namespaces_before; ++i) {
        UA_Server_addNamespace(server_, ("urn:metier:test:" + std::to_string(i)).c_str());
    }
    addVariable(server_, objects, {UA_Server_addNamespace(server_, kMovingUri), kMoving},
                kReadWrite);
}

MuteListener::MuteListener() : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const auto* any = reinterpret_cast<const sockaddr*>(&address);
    if (::bind(socket_, any, sizeof address) != 0 || ::listen(socket_, 5) != 0) {
        throw std::runtime_error("cannot listen");
    }
}

MuteListener::~MuteListener() {
    ::close(socket_);
}

std::string MuteListener::url() const {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    return urlOf(ntohs(address.sin_port));
}

std::unique_ptr<Client> connected(const std::string& url, ClientOptions options) {
    auto client = Client::connect(url, std::move(options));
    EXPECT_TRUE(client) << (client ? "" : client.error().message);
    return client ? std::move(*client) : nullptr;
}

void Condition::notify(const std::function<void()>& change) {
    {
        const std::lock_guard lock(mutex_);
        change();
    }
    changed_.notify_all();
}

bool Condition::wait(const std::function<bool()>& holds, std::chrono::milliseconds longest) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, longest, holds);
}

}  // namespace metier::opcua::testing
