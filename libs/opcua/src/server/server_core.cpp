#include "server/server_core.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/closed_methods.hpp"
#include "common/convert.hpp"
#include "common/guard.hpp"
#include "common/security_config.hpp"
#include "metier/opcua/text.hpp"
#include "nodesets/nodeset_loader.hpp"
#include "server/enum_properties.hpp"
#include "server/event_types.hpp"
#include "server/nodesets.hpp"
#include "server/server_config.hpp"

namespace metier::opcua {

namespace {

constexpr std::chrono::milliseconds kLongestWait{100};
constexpr std::chrono::milliseconds kFiguresEvery{50};

EventLoopOptions loopOptions(const ServerOptions& options, const UA_Logger* logger) {
    EventLoopOptions result;
    result.max_connections = options.limits.secure_channels;
    result.stranger_limit = options.limits.handshake_timeout;
    result.logger = logger;
    return result;
}

}  // namespace

/// Callbacks of the stack for nodes and monitored items.
struct ServerCore::Callbacks {
    /// The stack makes an Object for each session, by the session's id.
    static UA_StatusCode nodeMade(UA_Server* server, const UA_NodeId* /*session_id*/,
                                  void* /*session_context*/, const UA_NodeId* id,
                                  void** /*context*/) noexcept {
        if (id->namespaceIndex != 1 || id->identifierType != UA_NODEIDTYPE_GUID) {
            return UA_STATUSCODE_GOOD;
        }
        return guarded([&] {
            auto& core = ServerCore::of(server);
            core.sessions_.created(server, fromNative(*id), core.loop_.currentConnection());
        });
    }

    static void nodeDeleted(UA_Server* server, const UA_NodeId* /*session_id*/,
                            void* /*session_context*/, const UA_NodeId* /*id*/,
                            void* context) noexcept {
        if (context != nullptr) {
            ServerCore::of(server).hooks_.erase(context);
        }
    }

    static UA_StatusCode nameChild(UA_Server* server, const UA_NodeId* /*session_id*/,
                                   void* /*session_context*/, const UA_NodeId* source,
                                   const UA_NodeId* parent, const UA_NodeId* /*reference*/,
                                   UA_NodeId* target) noexcept {
        if (parent->namespaceIndex == 0) {
            return UA_STATUSCODE_GOOD;  // an event's node: any free id will do
        }
        return guarded([&]() -> UA_StatusCode {
            Owned<UA_QualifiedName> name(UA_TYPES[UA_TYPES_QUALIFIEDNAME]);
            const auto read = UA_Server_readBrowseName(server, *source, name.get());
            if (read == UA_STATUSCODE_GOOD) {
                toNative(childId(fromNative(*parent), fromNative(*name)), *target);
            }
            return read;
        });
    }

    static void monitored(UA_Server* server, const UA_NodeId* session, void* /*session_context*/,
                          const UA_NodeId* node, void* /*node_context*/, UA_UInt32 attribute,
                          UA_Boolean removed) noexcept {
        if (attribute != UA_ATTRIBUTEID_EVENTNOTIFIER) {
            return;
        }
        guarded([&] {
            auto& watch = ServerCore::of(server).watch_;
            const NodeId owner = session == nullptr ? NodeId() : fromNative(*session);
            if (removed) {
                watch.removed(fromNative(*node), owner);
            } else {
                watch.added(fromNative(*node), owner);
            }
        });
    }
};

ServerCore& ServerCore::of(UA_Server* server) noexcept {
    return *static_cast<ServerCore*>(UA_Server_getConfig(server)->context);
}

Result<std::unique_ptr<ServerCore>> ServerCore::create(ServerOptions options) {
    METIER_TRY(checkOptions(options));
    std::unique_ptr<ServerCore> core(new ServerCore(std::move(options)));
    METIER_TRY(core->build());
    return core;
}

ServerCore::ServerCore(ServerOptions options)
    : options_(std::move(options)),
      log_(options_.logger),
      loop_(loopOptions(options_, log_.handle())),
      sessions_(options_),
      hooks_(*this),
      nodes_(*this),
      audit_(*this) {}

ServerCore::~ServerCore() {
    stop();
}

Result<> ServerCore::build() {
    struct Config : UA_ServerConfig {
        Config() : UA_ServerConfig{} {}
        ~Config() { UA_ServerConfig_clean(this); }
        Config(const Config&) = delete;
        Config& operator=(const Config&) = delete;
    } config;
    config.logging = log_.handle();
    config.eventLoop = loop_.handle();
    config.context = this;
    METIER_TRY(checkPeers());
    METIER_TRY(applyOptions(options_, peers_.get(), config));
    sessions_.install(config);
    node_store_front_.install(config.nodestore);
    config.accessControl.getUserExecutable = userExecutable;
    config.nodeLifecycle.constructor = Callbacks::nodeMade;
    config.nodeLifecycle.destructor = Callbacks::nodeDeleted;
    config.nodeLifecycle.generateChildNodeId = Callbacks::nameChild;
    config.monitoredItemRegisterCallback = Callbacks::monitored;
    followSessions();
    server_.reset(UA_Server_newWithConfig(&config));
    if (!server_) {
        return fail(Errc::internal, "the stack could not make a server");
    }
    timers_ = std::make_shared<PendingTimers>(
        native(), [this](const std::function<void()>& work) { runGuarded(work); });
    METIER_TRY(loadNodes());
    METIER_TRY(inheritEventFields(native(), nodes_));
    METIER_TRY(addAbsentFields(nodes_));
    for (const auto& uri : options_.namespaces) {
        UA_Server_addNamespace(native(), uri.c_str());
    }
    METIER_TRY(stack_methods_.guard(native()));
    METIER_TRY(nodes_.write(NodeId(0, UA_NS0ID_SERVER_SERVERCAPABILITIES_SERVERPROFILEARRAY),
                            Value::of(profilesOf(options_))));
    // Certificates of others, and who they are.
    UA_Server_setNodeContext(
        native(),
        UA_NODEID_NUMERIC(
            0,
            UA_NS0ID_SERVER_SERVERDIAGNOSTICS_SESSIONSDIAGNOSTICSSUMMARY_SESSIONSECURITYDIAGNOSTICSARRAY),
        auditorsOnly());
    // The stack's own source says false.
    return nodes_.setDataSource(ids::kServerAuditing,
                                {[](const Session&) { return DataValue{Value::of(true)}; }});
}

/// Adds the nodes of the NodeSets: first those that are compiled in, also for the files. Their
/// Methods wait for work.
Result<> ServerCore::loadNodes() {
    METIER_ASSIGN(const auto files, readNodesetFiles(options_.nodeset_files));
    auto names = options_.nodesets;
    names.insert(names.end(), files.needed.begin(), files.needed.end());
    METIER_TRY(loadNodesets(native(), names));
    METIER_TRY(loadNodesetFiles(native(), files, data_types_, log()));
    METIER_TRY(defineByProperties(nodes_, data_types_));
    const auto closed = closeIdleMethods(native());
    return closed == UA_STATUSCODE_GOOD
               ? Result<>()
               : fail(errorFrom(StatusCode(closed), "close the Methods without work"));
}

Result<> ServerCore::addNodes(const NodesetFile& file) {
    NodesetLoader loader(native(), data_types_);
    METIER_TRY(loader.load(file));
    for (const auto& note : loader.notes()) {
        log().warn("{}", note);
    }
    return defineByProperties(nodes_, data_types_);
}

/// Installs the check of peers' certificates; for a closed server.
Result<> ServerCore::checkPeers() {
    if (!options_.security) {
        return {};
    }
    METIER_ASSIGN(auto peers, PeerCheck::create(options_.security->credentials.trust_folder,
                                                options_.security->on_refused));
    peers_ = std::move(peers);
    peers_->onRefusal([this](std::string_view der, StatusCode status, const std::string& why) {
        audit_.peerRefused(der, status, why);
    });
    peers_->onTrusted([this] { loop_.vouchFor(loop_.currentConnection()); });
    peers_->onSession([this](const std::string& thumbprint, const std::string& uri) {
        // Without a connection it is this server, which checks its own certificate.
        return loop_.currentConnection() == 0 || sessions_.mayCreate({thumbprint, uri});
    });
    return {};
}

void ServerCore::followSessions() {
    sessions_.onActivated([this](const Session& session) {
        seat(session);
        audit_.loggedIn(session);
    });
    sessions_.onRefused([this](const Session& session, StatusCode status, const std::string& why) {
        audit_.loginRefused(session, status, why);
    });
    sessions_.onClosed([this](const Session& session) {
        unseat(session);
        audit_.sessionClosed(session);
    });
}

void ServerCore::seat(const Session& session) {
    const auto connection = loop_.currentConnection();
    watch_.sessionOn(session.id, connection);
    const auto before = std::exchange(seats_[session.id], connection);
    if (before != connection) {
        loop_.admit(connection);
        loop_.dismiss(before);
    }
}

void ServerCore::unseat(const Session& session) {
    watch_.sessionClosed(session.id);
    const auto seat = seats_.extract(session.id);
    if (!seat.empty()) {
        loop_.dismiss(seat.mapped());
    }
}

Result<> ServerCore::start() {
    if (std::exchange(started_, true)) {
        return fail(Errc::invalid_state, "the server was started before");
    }
    std::promise<Result<>> opened;
    auto outcome = opened.get_future();
    thread_ = std::jthread([this, &opened](const std::stop_token& stop) { run(stop, opened); });
    auto result = outcome.get();
    if (!result) {
        stop();
    }
    return result;
}

void ServerCore::run(const std::stop_token& stop, std::promise<Result<>>& opened) {
    owner_ = std::this_thread::get_id();
    auto result = open();
    const bool serving = result.has_value();
    opened.set_value(std::move(result));  // start() may go on, and `opened` with it
    if (!serving) {
        return;
    }
    while (!stop.stop_requested()) {
        if (auto iterated = loop_.runOnce(kLongestWait); !iterated) {
            log().error("{}", iterated.error().message);
        }
        takeStatistics();
    }
    close();
}

void ServerCore::takeStatistics() {
    if (loop_.lastIteration() - figures_taken_ < kFiguresEvery) {
        return;
    }
    figures_taken_ = loop_.lastIteration();
    const auto now = loop_.statistics();
    figures_.connections = now.connections;
    figures_.sessions = sessions_.count();
    figures_.queued_bytes = now.queued_bytes;
    figures_.refused_connections = now.refused;
    figures_.cut_peers = now.cut_peers;
}

ServerStatistics ServerCore::statistics() const {
    return {.connections = figures_.connections,
            .sessions = figures_.sessions,
            .queued_bytes = figures_.queued_bytes,
            .waiting_work = queue_.size(),
            .refused_connections = figures_.refused_connections,
            .cut_peers = figures_.cut_peers};
}

Result<> ServerCore::open() {
    const auto code = UA_Server_run_startup(native());
    if (auto reason = loop_.lastNetworkError(); !reason.empty()) {
        if (code == UA_STATUSCODE_GOOD) {
            close();
        }
        return fail(Errc::already_exists, std::move(reason));
    }
    if (code != UA_STATUSCODE_GOOD) {
        return fail(errorFrom(StatusCode(code), "start the server"));
    }
    port_ = loop_.listening().at(0).port;
    tellSecurity();
    return {};
}

void ServerCore::tellDenial(const CallContext& context) {
    log().info("{} on {} denied to {}, who is {}", context.method.toString(),
               context.object.toString(), sanitise(context.session.user),
               security::toString(context.session.role));
    audit_.denied(context);
}

Result<> ServerCore::renewIdentity(const security::Identity& identity) {
    if (!options_.security) {
        return fail(Errc::invalid_state, "a server without security has no certificate");
    }
    auto options = options_;
    options.security->credentials.identity = identity;
    METIER_TRY(checkOptions(options));
    auto replaced = replaceIdentity(identity, *UA_Server_getConfig(native()));
    if (replaced) {
        options_.security->credentials.identity = identity;
        tellSecurity();
    }
    return replaced;
}

void ServerCore::tellSecurity() {
    const auto url = endpointUrlOf(options_.bind_addresses.at(0), port_);
    if (options_.security) {
        log().info("{} at {} has the certificate {}", options_.application_name, url,
                   options_.security->credentials.identity.certificate.thumbprint());
    } else {
        // The program that starts it decides how loudly to warn.
        log().info("INSECURE LAB: {} at {} has no encryption and lets anonymous users in",
                   options_.application_name, url);
    }
}

void ServerCore::close() {
    sessions_.closeIf(native(), [](const Session&) { return true; });
    audit_.tellLeftOut();
    UA_Server_run_shutdown(native());
}

void ServerCore::stop() {
    // Posted work may own things that use the server's timers: it is destroyed once the thread has
    // ended.
    const auto dropped = queue_.close();
    if (thread_.joinable()) {
        thread_.request_stop();
        loop_.post([] {});  // wakes it
        thread_.join();
    }
    owner_ = creator_;
}

void ServerCore::post(std::function<void()> work) {
    if (queue_.push(std::move(work)) != WorkQueue::Pushed::first) {
        return;
    }
    loop_.post(
        [this] { queue_.drain([this](const std::function<void()>& each) { runGuarded(each); }); });
}

TimerHandle ServerCore::after(std::chrono::nanoseconds delay, std::function<void()> work) {
    return PendingTimers::start(timers_, delay, std::move(work));
}

bool ServerCore::onServerThread() const noexcept {
    return owner_ == std::this_thread::get_id();
}

void ServerCore::runGuarded(const std::function<void()>& work) noexcept {
    if (guarded(work) != UA_STATUSCODE_GOOD) {
        log().error("posted work or a timer threw an exception");
    }
}

bool ServerCore::nobodyHears(const NodeId& source) const {
    const auto known = notifiers_.find(source);
    return known != notifiers_.end() && !watch_.watchesAny(known->second);
}

UA_StatusCode ServerCore::raise(const NodeId& event, const NodeId& source, UA_ByteString* id) {
    raises_event_ = true;
    const auto code =
        UA_Server_triggerEvent(server_.get(), viewOf(event), viewOf(source), id, false);
    raises_event_ = false;
    return code;
}

void ServerCore::publishEventsOf(const NodeId& source) {
    const auto& notifiers = notifiersAbove(source);
    if (options_.event_publishing != EventPublishing::at_once || watch_.empty()) {
        return;
    }
    const auto connections = watch_.connectionsOf(notifiers);
    if (!connections.empty()) {
        loop_.flushPublishing(connections);
    }
}

const std::vector<NodeId>& ServerCore::notifiersAbove(const NodeId& source) {
    const auto [entry, is_new] = notifiers_.try_emplace(source);
    auto& found = entry->second;
    if (!is_new) {
        return found;
    }
    found = {source, ids::kServer};
    for (std::size_t next = 0; next < found.size(); ++next) {
        const auto above = nodes_.browse(
            found[next], {ids::kHierarchicalReferences, BrowseFilter::Direction::inverse});
        for (const auto& reference : above.value_or(std::vector<Reference>())) {
            if (std::find(found.begin(), found.end(), reference.target) == found.end()) {
                found.push_back(reference.target);
            }
        }
    }
    return found;
}

}  // namespace metier::opcua
