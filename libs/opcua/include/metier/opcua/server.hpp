#pragma once

#include <fmt/format.h>
#include <spdlog/logger.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/base/histogram.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/opcua/audit.hpp"
#include "metier/opcua/security.hpp"
#include "metier/opcua/session.hpp"

namespace metier::opcua {

/// Time at which the notifications of an event leave the server.
enum class EventPublishing {
    /// Right after it was raised, whatever publishing interval a client asked for.
    at_once,
    /// Strictly at the Subscription's publishing interval.
    at_interval,
};

/// Limits for the clients of a server; a request beyond them is refused or gets less.
///
/// A limit of zero is refused by Server::create(). What clients get instead of a refusal is revised
/// by the server, as OPC 10000-4 allows: intervals, time-outs and sizes of queues.
struct ServerLimits {
    /// Connections, with or without a SecureChannel yet. When all are taken, one without a Session
    /// is closed for the next.
    std::uint16_t secure_channels = 150;
    /// Longest time that a connection may be without a Session.
    std::chrono::milliseconds handshake_timeout{10'000};
    /// Sessions at the same time, of all clients.
    std::uint16_t sessions = 100;
    /// Sessions of one application, known by its certificate; only for a closed server.
    std::uint16_t sessions_per_application = 10;
    /// Longest session time-out that a client gets.
    std::chrono::milliseconds session_timeout{60'000};
    /// Largest message [byte].
    std::uint32_t message_size = 1U << 20U;
    /// Largest number of chunks of a message.
    std::uint32_t chunks_per_message = 32;
    /// Subscriptions at the same time, of all sessions.
    std::uint32_t subscriptions = 1000;
    /// Subscriptions of one session.
    std::uint32_t subscriptions_per_session = 10;
    /// MonitoredItems at the same time, of all sessions.
    std::uint32_t monitored_items = 10'000;
    /// MonitoredItems of one Subscription.
    std::uint32_t monitored_items_per_subscription = 1'000;
    /// Largest number of events that wait in one MonitoredItem.
    std::uint32_t event_queue = 10'000;
    /// Shortest publishing interval that a client gets; the stack can do 5 ms.
    std::chrono::milliseconds min_publishing_interval{5};
    /// Shortest sampling interval that a client gets; the stack can do 5 ms.
    std::chrono::milliseconds min_sampling_interval{5};
    /// Longest publishing interval that a client gets.
    std::chrono::milliseconds max_publishing_interval{10'000};
    /// Number of publishing intervals that a Subscription waits for its client.
    /// When it passes, the Subscription is deleted.
    std::uint32_t lifetime_count = 600;
    /// Publish requests of one session that wait for notifications.
    std::uint32_t publish_requests_per_session = 20;
    /// Sent notifications that a Subscription keeps until they are acknowledged.
    std::uint32_t retransmission_queue = 20;
    /// Nodes in one Read request; a request with more is refused with BadTooManyOperations.
    std::uint32_t nodes_per_read = 1'000;
    /// Values in one Write request.
    std::uint32_t nodes_per_write = 200;
    /// Methods in one Call request.
    std::uint32_t nodes_per_call = 10;
    /// Nodes in one Browse request.
    std::uint32_t nodes_per_browse = 1'000;
    /// References of a node in one Browse answer; BrowseNext gives the next ones.
    std::uint32_t references_per_node = 1'000;
};

/// Makes a server a Local Discovery Server (OPC 10000-12).
struct DiscoveryService {
    /// A registration that is not renewed for that long is removed, within a second or two; whole
    /// seconds, at least one.
    std::chrono::seconds forget_after{75};
};

/// Settings of a Server.
///
///     ServerOptions options{.application_name = "cell 3", .port = 0};
///     options.nodesets = {"metier", "universal_robots"};
///     options.security = ServerSecurity{...};  // without it only this machine can connect
struct ServerOptions {
    /// Name for people.
    std::string application_name = "metier";
    /// ApplicationUri, unique among servers; with security it must be that of the certificate.
    std::string application_uri = "urn:metier:server";
    /// TCP port; 0: a free one, see Server::port().
    std::uint16_t port = 4840;
    /// Addresses on which it listens; the first one is that of endpointUrl(). Without security only
    /// loopback addresses are allowed.
    std::vector<std::string> bind_addresses{"127.0.0.1"};
    /// Security of a closed server; none: no encryption and anonymous users, for a lab.
    std::optional<ServerSecurity> security{};
    /// NodeSets by short name. Any of device, robotics, metier brings the whole skill model with
    /// the official NodeSets that it needs; iiwa, edo, universal_robots add the instances of a
    /// robot, wsg50 those of a gripper.
    std::vector<std::string> nodesets;
    /// NodeSet2.xml files, in any order. Their required models are taken from each other and from
    /// the compiled NodeSets, which are added where a file needs them.
    std::vector<std::filesystem::path> nodeset_files{};
    /// URIs of further namespaces, in the order of their indices.
    std::vector<std::string> namespaces;
    /// Time at which notifications of events are sent.
    EventPublishing event_publishing = EventPublishing::at_once;
    /// Called for each audit record: actions and refused attempts of sessions, and actions of the
    /// server; may be empty. Runs on the server's thread and must not wait.
    std::function<void(const AuditRecord&)> on_audit{};
    /// Lets other servers register here; FindServers lists them. None: nobody can register.
    std::optional<DiscoveryService> discovery{};
    /// Limits for clients.
    ServerLimits limits;
    /// Shared with its other users, as spdlog does; null: spdlog's default logger.
    std::shared_ptr<spdlog::logger> logger;
};

/// Figures of a server's load; at most 100 ms old while its thread works.
/// All but waiting_work are zero before start().
struct ServerStatistics {
    /// Open connections, with or without a session.
    std::size_t connections = 0;
    /// Sessions, activated or not.
    std::size_t sessions = 0;
    /// Bytes that wait for peers to read.
    std::size_t queued_bytes = 0;
    /// Pieces of work that were posted to the server's thread and have not begun.
    std::size_t waiting_work = 0;
    /// Connections that were refused or closed for want of a free place, since the start.
    std::uint64_t refused_connections = 0;
    /// Connections that were closed, since their peer did not read what was sent to it.
    std::uint64_t cut_peers = 0;
};

/// A timer that is cancelled at the end of its life.
///
/// Keep it: a handle that is dropped cancels its timer at once.
/// Threading: the server's thread. May outlive the Server.
class TimerHandle {
public:
    /// A handle of no timer.
    TimerHandle() = default;
    explicit TimerHandle(std::function<void()> cancel) : cancel_(std::move(cancel)) {}
    ~TimerHandle() { cancel(); }
    /// The moved-from handle has no timer.
    TimerHandle(TimerHandle&& other) noexcept : cancel_(std::exchange(other.cancel_, nullptr)) {}
    /// Cancels the timer that this handle had before.
    TimerHandle& operator=(TimerHandle&& other) noexcept;
    /// Cancels the timer. Does nothing if it has run or was cancelled before.
    void cancel() noexcept;

private:
    std::function<void()> cancel_;
};

/// Wraps a type into a Result once: Result<T> stays Result<T>.
template <typename T>
struct AsResult {
    using Type = Result<T>;
};
template <typename T>
struct AsResult<Result<T>> {
    using Type = Result<T>;
};
/// Result type of Server::call() for work that returns R or Result<R>: Result<R>.
template <typename Work>
using ResultOf = typename AsResult<std::invoke_result_t<Work&>>::Type;

/// An OPC UA server. Without security it logs a warning when it starts.
///
///     auto server = Server::create({.port = 0, .nodesets = {"metier"}});
///     (*server)->nodes().addVariable({...});  // before start(): the creating thread
///     (*server)->start();
///
/// Threading: between start() and stop() one thread of its own does all work and calls all
/// handlers. Before and after that, the thread that created it takes its place. Each function says
/// which thread may call it.
///
/// A complete exchange with the server's thread, from any other one:
///
///     const auto value = server.call([&] { return server.nodes().read(id); });
///     server.post([&server, id] { static_cast<void>(server.nodes().write(id, Value::of(1.0))); });
class Server {
public:
    /// Makes the server and loads its NodeSets, which waits for the disk; nothing is open yet.
    /// Errors: invalid_argument (an address that is not loopback, a limit of zero, a certificate
    ///         for another ApplicationUri; with a line "file:line: why" for each mistake in a
    ///         NodeSet file), resource_unavailable (the trust folder), not_found (NodeSet),
    ///         internal (the stack).
    static Result<std::unique_ptr<Server>> create(ServerOptions options);
    /// Stops it.
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    /// Opens the port and serves clients. Creating thread; once.
    /// Returns once the port is open. After an error the server has been stopped; make a new one.
    /// Errors: already_exists (the port is taken), invalid_state (started before).
    Result<> start();
    /// Closes all sessions and ends the server's thread. Work posted and not begun is dropped.
    /// Creating thread; may be called again.
    /// Waits for the work that runs; onSessionClosed() is called for each session.
    void stop();

    /// `opc.tcp://127.0.0.1:<port>` with the real port; empty before start(). Any thread.
    std::string endpointUrl() const;
    /// Port on which it listens; 0 before start(). Any thread.
    std::uint16_t port() const;

    /// Runs work on the server's thread, in the order of posting. Any thread; does not wait.
    /// Work posted before start() runs after it. An exception is logged and goes no further.
    /// Work posted after stop() is dropped. Everything that it captures must live until it has run
    /// or was dropped; it may be destroyed on the thread that calls stop().
    void post(std::function<void()> work);

    /// Runs work on the server's thread and waits for its result, R or Result<R>. Any thread but a
    /// cycle thread. Work that has not begun at the deadline never will; work that has begun goes
    /// on alone, so it must own all that it uses.
    /// Errors: timeout, cancelled (the server stopped), and the work's own.
    template <typename Work>
    ResultOf<Work> call(Work work, std::chrono::milliseconds deadline = std::chrono::seconds(5));

    /// Runs work once, unless the handle is cancelled or destroyed before. Server's thread.
    /// \param delay by the monotonic clock; 0 or less: as soon as possible, not inside this call
    [[nodiscard]] TimerHandle after(std::chrono::nanoseconds delay, std::function<void()> work);

    /// Calls the handler when a session has ended: closed, timed out or ended by stop(). Handlers
    /// run on the server's thread and stay for the server's life. Server's thread.
    /// Handlers are called in the order of these calls.
    void onSessionClosed(std::function<void(const Session&)> handler);

    /// The nodes of this server. Server's thread.
    /// Valid as long as the Server.
    AddressSpace& nodes();
    /// Records an action of the server itself, as an audit event and for on_audit. Server's thread.
    void audit(const OwnAct& act);

    /// Closes the sessions for which `which` returns true. Server's thread.
    /// onSessionClosed() is called for each.
    void closeSessions(const std::function<bool(const Session&)>& which);

    /// Replaces certificate and key, for the same ApplicationUri. Open connections stay until their
    /// next renewal, within ten minutes; then their clients connect again. Server's thread.
    /// Errors: invalid_argument (another ApplicationUri, a key that does not fit), invalid_state
    ///         (a server without security).
    Result<> renewIdentity(const security::Identity& identity);

    /// Time at which the server's thread last worked; it does at least every 100 ms. Any thread.
    /// If it is older, the thread hangs in some work, or the machine is overloaded: a server gives
    /// this to its device::Watchdog.
    SteadyTime lastTick() const noexcept;
    /// Whether the caller runs on the server's thread; before start() and after stop() the creating
    /// one counts. Any thread.
    bool onServerThread() const noexcept;
    /// Any thread; does not wait for the server's.
    /// Present figures.
    ServerStatistics statistics() const;
    /// Times from raising an event to handing it to the socket, one per Subscription that is
    /// notified at once. Any thread.
    const TimeHistogram& publishLatency() const noexcept;

private:
    friend class EventEmitter;
    explicit Server(std::unique_ptr<ServerCore> core);

    std::unique_ptr<ServerCore> core_;
};

/// Runs the work; a std::exception becomes internal with its text. Used by Server::call().
template <typename Work>
ResultOf<Work> runAsResult(Work& work) {
    try {
        if constexpr (std::is_void_v<std::invoke_result_t<Work&>>) {
            work();
            return {};
        } else {
            return work();
        }
    } catch (const std::exception& error) {
        return fail(Errc::internal, error.what());
    }
}

// On the server's own thread it would wait for itself: the work runs at once there.
template <typename Work>
ResultOf<Work> Server::call(Work work, std::chrono::milliseconds deadline) {
    if (onServerThread()) {
        return runAsResult(work);
    }
    struct Posted {
        Work work;
        std::promise<ResultOf<Work>> outcome;
    };
    // Both are shared: the task because a posted function is copied, the mark with this function.
    auto task = std::make_shared<Posted>(Posted{std::move(work), {}});
    const auto taken = std::make_shared<std::atomic<bool>>(false);
    auto outcome = task->outcome.get_future();
    post([task = std::move(task), taken] {
        if (!taken->exchange(true)) {
            task->outcome.set_value(runAsResult(task->work));
        }
    });
    if (outcome.wait_for(deadline) != std::future_status::ready) {
        const bool begun = taken->exchange(true);
        return fail(Errc::timeout, fmt::format("the server's thread did not {} within {} ms",
                                               begun ? "finish" : "begin", deadline.count()));
    }
    try {
        return outcome.get();
    } catch (const std::future_error&) {
        return fail(Errc::cancelled, "the server stopped");
    }
}

}  // namespace metier::opcua
