#pragma once

#include <open62541/plugin/eventloop.h>

#include <asio/ip/tcp.hpp>
#include <asio/steady_timer.hpp>
#include <span>
#include <string>

#include "event_loop.hpp"
#include "fair_queue.hpp"
#include "inbox.hpp"
#include "message_counter.hpp"
#include "response_gate.hpp"
#include "send_queue.hpp"

namespace metier::opcua {

/// Application of the stack that gets the events of a connection.
struct Application {
    UA_ConnectionManager_connectionCallback callback = nullptr;
    void* application = nullptr;
    void* context = nullptr;  ///< the stack changes it through the callback
};

enum class Origin { accepted, opened };

/// One TCP connection: its socket and what the peer has not taken yet. Nothing here waits.
///
/// Threading: under the loop's mutex.
class Connection {
public:
    Connection(ConnectionId id, asio::ip::tcp::socket socket, Application application,
               Origin origin);

    ConnectionId id() const { return id_; }
    Origin origin() const { return origin_; }
    asio::ip::tcp::socket& socket() { return socket_; }
    asio::steady_timer& timer() { return timer_; }
    /// Timer that closes the connection if its peer is not admitted in time.
    asio::steady_timer& patience() { return patience_; }
    Application& application() { return application_; }
    bool closing() const { return closing_; }

    /// Makes an open socket fit for the stack's messages. \param send_buffer [byte], 0: as it is
    asio::error_code configure(int send_buffer);
    /// Reads what is there, at most buffer.size(). Errors: would_block, eof, ...
    std::size_t receive(std::span<std::uint8_t> buffer, asio::error_code& error);
    /// Writes what the kernel takes at once and queues the rest.
    asio::error_code send(NetworkBuffer buffer);
    asio::error_code writeQueued();
    std::size_t queuedBytes() const { return queue_.size(); }
    /// Whether the peer's TCP acknowledged anything since the last call.
    bool progressed();

    /// Closes the socket and drops queued data. The manager notifies the application later.
    void close();
    /// Makes the kernel drop, on close(), what the peer did not take.
    void forget();

    bool connected;  ///< an opened connection is connected later
    bool awaits_writable = false;
    MessageCounter incoming;  ///< of an opened connection, as the next one
    ResponseGate gate;
    Standing standing = Standing::member;
    std::size_t sessions = 0;  ///< number of its Sessions, if admitted
    std::string address{};     ///< the peer's address, of an accepted connection
    Inbox inbox{};             ///< of an accepted connection

private:
    ConnectionId id_;
    asio::ip::tcp::socket socket_;
    asio::steady_timer timer_;  ///< connecting takes too long, then: the peer stalls
    asio::steady_timer patience_;
    Application application_;
    Origin origin_;
    SendQueue queue_;
    std::uint64_t written_ = 0;       ///< [byte] given to the kernel
    std::uint64_t acknowledged_ = 0;  ///< [byte] when progressed() last looked
    bool closing_ = false;
};

}  // namespace metier::opcua
