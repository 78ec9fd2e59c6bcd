#pragma once

#include <open62541/server.h>

#include <atomic>
#include <future>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "common/log_bridge.hpp"
#include "common/peer_check.hpp"
#include "event_loop/event_loop.hpp"
#include "metier/opcua/server.hpp"
#include "nodesets/data_types.hpp"
#include "nodesets/nodeset_file.hpp"
#include "server/audit_trail.hpp"
#include "server/event_watch.hpp"
#include "server/node_hooks.hpp"
#include "server/node_store_front.hpp"
#include "server/pending_timers.hpp"
#include "server/sessions.hpp"
#include "server/stack_methods.hpp"
#include "server/work_queue.hpp"

namespace metier::opcua {

/// The stack's server and what belongs to it; the inside of Server.
///
/// Threading: as Server.
class ServerCore {
public:
    static Result<std::unique_ptr<ServerCore>> create(ServerOptions options);
    ~ServerCore();
    ServerCore(const ServerCore&) = delete;
    ServerCore& operator=(const ServerCore&) = delete;

    /// The core of a server of the stack.
    static ServerCore& of(UA_Server* server) noexcept;

    Result<> start();
    void stop();
    void post(std::function<void()> work);
    TimerHandle after(std::chrono::nanoseconds delay, std::function<void()> work);
    bool onServerThread() const noexcept;
    std::uint16_t port() const noexcept { return port_; }
    SteadyTime lastTick() const noexcept { return loop_.lastIteration(); }
    ServerStatistics statistics() const;
    const TimeHistogram& publishLatency() const noexcept { return loop_.publishLatency(); }
    const ServerOptions& options() const noexcept { return options_; }

    UA_Server* native() noexcept { return server_.get(); }
    Sessions& sessions() noexcept { return sessions_; }
    HookRegistry& hooks() noexcept { return hooks_; }
    AddressSpace& nodes() noexcept { return nodes_; }
    const StackMethods& stackMethods() const noexcept { return stack_methods_; }
    AuditTrail& audit() noexcept { return audit_; }
    spdlog::logger& log() noexcept { return log_.target(); }

    /// Nodes or references changed: what was learned about notifiers holds no more.
    void structureChanged() { notifiers_.clear(); }
    /// Adds the nodes of a NodeSet whose required models are there.
    Result<> addNodes(const NodesetFile& file);
    /// Publishes to those who watch the events of an Object, if the options ask for it.
    void publishEventsOf(const NodeId& source);
    /// Whether work on the present message may go on: no client may keep the others waiting with a
    /// message that names the most expensive nodes again and again.
    bool mayWorkOn() const { return raises_event_ || loop_.workOnTurn() < kLongestWorkOnAMessage; }
    /// Raises the event that a node holds. Its fields are read for the subscribers even if the
    /// present message has used up its time.
    UA_StatusCode raise(const NodeId& event, const NodeId& source, UA_ByteString* id);
    Result<> renewIdentity(const security::Identity& identity);
    /// A session called what its role does not allow.
    void tellDenial(const CallContext& context);
    /// Whether anybody subscribed the events of an Object.
    bool isWatched(const NodeId& notifier) const { return watch_.watchesAny({&notifier, 1}); }
    /// Whether an event of a source that raised one before would reach no subscriber.
    bool nobodyHears(const NodeId& source) const;

private:
    static constexpr std::chrono::milliseconds kLongestWorkOnAMessage{20};

    struct DeleteServer {
        void operator()(UA_Server* server) const noexcept { UA_Server_delete(server); }
    };
    struct Callbacks;

    explicit ServerCore(ServerOptions options);
    Result<> build();
    Result<> loadNodes();
    Result<> checkPeers();
    void followSessions();
    void run(const std::stop_token& stop, std::promise<Result<>>& opened);
    Result<> open();
    void tellSecurity();
    void seat(const Session& session);
    void unseat(const Session& session);
    void close();
    void takeStatistics();
    void runGuarded(const std::function<void()>& work) noexcept;
    const std::vector<NodeId>& notifiersAbove(const NodeId& source);

    ServerOptions options_;
    LogBridge log_;
    AsioEventLoop loop_;
    Sessions sessions_;
    std::unique_ptr<PeerCheck> peers_;  ///< of a closed server
    EventWatch watch_;
    std::unordered_map<NodeId, ConnectionId> seats_;  ///< connection on which each Session is used
    DataTypeStore data_types_;  ///< outlives the server and the hooks, which point into it
    HookRegistry hooks_;
    StackMethods stack_methods_;
    AddressSpace nodes_;
    std::unordered_map<NodeId, std::vector<NodeId>> notifiers_;
    NodeStoreFront node_store_front_{data_types_};  ///< outlives the server, which points into it
    std::unique_ptr<UA_Server, DeleteServer> server_;
    std::shared_ptr<PendingTimers> timers_;  ///< shared for the weak pointers of handles
    AuditTrail audit_;
    WorkQueue queue_;
    bool raises_event_ = false;  ///< at this moment
    std::atomic<std::uint16_t> port_{0};
    /// For those who must not wait for the thread that counts.
    struct Figures {
        std::atomic<std::size_t> connections{0};
        std::atomic<std::size_t> sessions{0};
        std::atomic<std::size_t> queued_bytes{0};
        std::atomic<std::uint64_t> refused_connections{0};
        std::atomic<std::uint64_t> cut_peers{0};
    };
    Figures figures_;
    SteadyTime figures_taken_{};
    const std::thread::id creator_ = std::this_thread::get_id();
    std::atomic<std::thread::id> owner_ = creator_;
    bool started_ = false;
    std::jthread thread_;
};

}  // namespace metier::opcua
