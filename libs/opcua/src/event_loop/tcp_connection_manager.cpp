#include "tcp_connection_manager.hpp"

#include <open62541/plugin/log.h>
#include <sys/socket.h>

#include <algorithm>
#include <asio/post.hpp>
#include <ctime>
#include <utility>

namespace metier::opcua {

namespace {

constexpr std::size_t kReceiveBufferSize = std::size_t{64} << 10U;
constexpr int kStallChecks = 8;                // within the stall limit
constexpr std::chrono::milliseconds kTurn{1};  // after it no further message is begun

/// Whether the peer has closed and all its data was read. This is checked out of turn: until it is
/// known, events of others would be sent to the peer, and be lost.
bool hasLeft(Connection& connection) {
    char next = 0;
    return ::recv(connection.socket().native_handle(), &next, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

std::chrono::nanoseconds threadTime() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace

TcpConnectionManager::TcpConnectionManager(Reactor& reactor, Publisher& publisher,
                                           const EventLoopOptions& options)
    : reactor_(reactor),
      publisher_(publisher),
      options_(options),
      resolver_(reactor.io()),
      receive_buffer_(kReceiveBufferSize) {}

Result<> TcpConnectionManager::open(const UA_KeyValueMap* parameters,
                                    const Application& application) {
    if (handle_.eventSource.state != UA_EVENTSOURCESTATE_STARTED) {
        return fail(Errc::cancelled, "the event loop is not running");
    }
    auto tcp = readTcpParameters(parameters);
    if (!tcp) {
        note(tcp.error().message);
        return fail(tcp.error());
    }
    if (tcp->listen) {
        return listen(*tcp, application);
    }
    if (!tcp->validate) {
        connect(*tcp, application);
    }
    return {};
}

UA_StatusCode TcpConnectionManager::send(ConnectionId id, UA_ByteString* buffer) {
    NetworkBuffer bytes(buffer);
    auto* connection = find(id);
    if (connection == nullptr) {
        return UA_STATUSCODE_BADCONNECTIONCLOSED;
    }
    publisher_.sent(id, bytes.unsent());
    if (connection->send(std::move(bytes))) {
        closeLater(*connection);
        return UA_STATUSCODE_BADCONNECTIONCLOSED;
    }
    if (connection->queuedBytes() > options_.send_queue_limit) {
        cut(*connection, "is owed too much");
        return UA_STATUSCODE_BADCONNECTIONCLOSED;
    }
    if (connection->queuedBytes() > 0 && !connection->awaits_writable) {
        awaitWritable(*connection);
        connection->progressed();
        watchStall(*connection, std::chrono::steady_clock::now());
    }
    return UA_STATUSCODE_GOOD;
}

UA_StatusCode TcpConnectionManager::close(ConnectionId id) {
    if (auto* connection = find(id)) {
        closeLater(*connection);
        return UA_STATUSCODE_GOOD;
    }
    const auto listener = listeners_.find(id);
    if (listener == listeners_.end()) {
        return UA_STATUSCODE_BADNOTFOUND;
    }
    closeListener(*listener->second);
    return UA_STATUSCODE_GOOD;
}

void TcpConnectionManager::dropOpened() {
    for (auto& [id, connection] : connections_) {
        if (connection->origin() == Origin::opened && !connection->closing()) {
            connection->forget();
            closeLater(*connection);
        }
    }
}

void TcpConnectionManager::start() {
    handle_.eventSource.state = UA_EVENTSOURCESTATE_STARTED;
}

void TcpConnectionManager::stop() {
    handle_.eventSource.state = UA_EVENTSOURCESTATE_STOPPING;
    for (auto& [id, connection] : connections_) {
        closeLater(*connection);
    }
    for (auto& [id, listener] : listeners_) {
        closeListener(*listener);
    }
    resolver_.cancel();
}

bool TcpConnectionManager::stopped() const {
    return connections_.empty() && listeners_.empty();
}

bool TcpConnectionManager::deliverLeftovers() {
    const auto with_leftovers = std::exchange(leftovers_, {});
    for (const auto id : with_leftovers) {
        if (auto* connection = find(id)) {
            tell(*connection, UA_CONNECTIONSTATE_ESTABLISHED, UA_KEYVALUEMAP_NULL,
                 UA_BYTESTRING_NULL);
        }
    }
    return !with_leftovers.empty();
}

EventLoopStatistics TcpConnectionManager::statistics() const {
    auto statistics = counts_;
    statistics.connections = connections_.size();
    for (const auto& [id, connection] : connections_) {
        statistics.queued_bytes += connection->queuedBytes();
    }
    return statistics;
}

std::vector<ListenAddress> TcpConnectionManager::listening() const {
    std::vector<ListenAddress> addresses;
    for (const auto& [id, listener] : listeners_) {
        addresses.push_back(listener->address);
    }
    return addresses;
}

Connection* TcpConnectionManager::find(ConnectionId id) {
    const auto found = connections_.find(id);
    const bool open = found != connections_.end() && !found->second->closing();
    return open ? found->second.get() : nullptr;
}

Connection& TcpConnectionManager::add(asio::ip::tcp::socket socket, const Application& application,
                                      Origin origin) {
    const auto id = ++last_id_;
    auto connection = std::make_unique<Connection>(id, std::move(socket), application, origin);
    return *connections_.emplace(id, std::move(connection)).first->second;
}

void TcpConnectionManager::tell(Connection& connection, UA_ConnectionState state,
                                const UA_KeyValueMap& parameters, UA_ByteString message) {
    const auto current = connection.origin() == Origin::accepted ? connection.id() : 0;
    const auto outer = std::exchange(current_accepted_, current);
    auto& application = connection.application();
    application.callback(&handle_, connection.id(), application.application, &application.context,
                         state, &parameters, message);
    current_accepted_ = outer;
}

void TcpConnectionManager::awaitReadable(Connection& connection) {
    connection.socket().async_wait(
        asio::ip::tcp::socket::wait_read,
        reactor_.guarded([this, id = connection.id()](const asio::error_code&) {
            auto* readable = find(id);
            if (readable != nullptr && hasLeft(*readable)) {
                closeLater(*readable);
            } else if (readable != nullptr) {
                turns_.ready(id, readable->standing, std::chrono::steady_clock::now());
            }
        }));
}

bool TcpConnectionManager::takeTurn() {
    const auto id = turns_.next();
    if (!id) {
        return false;
    }
    if (auto* connection = find(*id)) {
        turn_began_ = threadTime();
        readFrom(*connection);  // it lives at least until its CLOSING callback
        turns_.used(workOnTurn());
        turn_began_.reset();
    }
    return true;
}

std::chrono::nanoseconds TcpConnectionManager::workOnTurn() const {
    return turn_began_ ? threadTime() - *turn_began_ : std::chrono::nanoseconds::zero();
}

void TcpConnectionManager::readFrom(Connection& connection) {
    if (connection.inbox.empty()) {
        asio::error_code failed;
        const auto received = connection.receive(receive_buffer_, failed);
        if (failed && failed != asio::error::would_block) {
            closeLater(connection);
            return;
        }
        hear(connection, std::span(receive_buffer_).first(received));
    } else {
        hear(connection, {});
    }
    if (connection.closing()) {
        return;
    }
    if (!connection.inbox.empty()) {
        turns_.ready(connection.id(), connection.standing, std::chrono::steady_clock::now());
    } else {
        awaitReadable(connection);
    }
}

void TcpConnectionManager::hear(Connection& connection, std::span<std::uint8_t> bytes) {
    if (connection.origin() == Origin::opened) {
        deliver(connection, bytes);
        return;
    }
    connection.inbox.push(bytes);
    while (!connection.closing() && !connection.inbox.empty() && workOnTurn() < kTurn) {
        deliver(connection, connection.inbox.take());
    }
    connection.inbox.done();
}

void TcpConnectionManager::deliver(Connection& connection, std::span<std::uint8_t> bytes) {
    if (bytes.empty()) {
        return;
    }
    if (connection.origin() == Origin::opened && !connection.gate.feed(bytes)) {
        return cut(connection, "sends what is no answer");
    }
    if (connection.origin() == Origin::accepted) {
        publisher_.received(connection.id(), bytes);
    } else if (connection.incoming.feed(bytes) > 1) {
        leftovers_.push_back(connection.id());
    }
    tell(connection, UA_CONNECTIONSTATE_ESTABLISHED, UA_KEYVALUEMAP_NULL,
         {bytes.size(), bytes.data()});
}

void TcpConnectionManager::awaitWritable(Connection& connection) {
    connection.awaits_writable = true;
    connection.socket().async_wait(
        asio::ip::tcp::socket::wait_write,
        reactor_.guarded(
            [this, id = connection.id()](const asio::error_code&) { onWritable(id); }));
}

void TcpConnectionManager::onWritable(ConnectionId id) {
    auto* connection = find(id);
    if (connection == nullptr) {
        return;
    }
    connection->awaits_writable = false;
    if (connection->writeQueued()) {
        closeLater(*connection);
    } else if (connection->queuedBytes() > 0) {
        awaitWritable(*connection);
    } else {
        connection->timer().cancel();
    }
}

void TcpConnectionManager::watchStall(Connection& connection, SteadyTime progress) {
    connection.timer().expires_after(options_.stall_limit / kStallChecks);
    connection.timer().async_wait(
        reactor_.guarded([this, id = connection.id(), progress](const asio::error_code& cancelled) {
            auto* stalled = cancelled ? nullptr : find(id);
            if (stalled == nullptr || stalled->queuedBytes() == 0) {
                return;
            }
            const auto now = std::chrono::steady_clock::now();
            const auto since = stalled->progressed() ? now : progress;
            if (now - since >= options_.stall_limit) {
                cut(*stalled, "takes nothing");
            } else {
                watchStall(*stalled, since);
            }
        }));
}

void TcpConnectionManager::closeLater(Connection& connection) {
    if (connection.closing()) {
        return;
    }
    connection.close();
    ++closing_;
    turns_.forget(connection.id());
    publisher_.closed(connection.id());
    asio::post(reactor_.io(), reactor_.guarded([this, id = connection.id()] { finish(id); }));
}

void TcpConnectionManager::cut(Connection& connection, const char* reason) {
    ++counts_.cut_peers;
    UA_LOG_WARNING(options_.logger, UA_LOGCATEGORY_NETWORK,
                   "TCP %lu | the peer is cut: it %s (%lu bytes wait)",
                   static_cast<unsigned long>(connection.id()), reason,
                   static_cast<unsigned long>(connection.queuedBytes()));
    connection.forget();
    closeLater(connection);
}

void TcpConnectionManager::finish(ConnectionId id) {
    const auto found = connections_.find(id);
    if (found == connections_.end()) {
        return;
    }
    const auto connection = std::move(found->second);
    connections_.erase(found);
    --closing_;
    tell(*connection, UA_CONNECTIONSTATE_CLOSING, UA_KEYVALUEMAP_NULL, UA_BYTESTRING_NULL);
}

void TcpConnectionManager::note(std::string error) {
    last_error_ = std::move(error);
    UA_LOG_WARNING(options_.logger, UA_LOGCATEGORY_NETWORK, "TCP | %s", last_error_.c_str());
}

}  // namespace metier::opcua
