#pragma once

#include <array>
#include <memory>
#include <optional>
#include <random>
#include <unordered_map>

#include "connection.hpp"
#include "fair_queue.hpp"
#include "listener.hpp"
#include "publisher.hpp"
#include "reactor.hpp"

namespace metier::opcua {

/// The stack's way to TCP: opens, accepts, reads, sends and closes connections.
///
/// Every connection ends with exactly one CLOSING callback, never from inside another call.
/// Handlers of Asio know connections by id only, so one that comes late finds nothing.
/// Threading: under the loop's mutex; handlers take it.
class TcpConnectionManager {
public:
    TcpConnectionManager(Reactor& reactor, Publisher& publisher, const EventLoopOptions& options);

    UA_ConnectionManager* handle() { return &handle_; }

    /// Errors: those of readTcpParameters() and openAcceptors(); cancelled (the loop stops).
    /// A failure to connect is reported by the CLOSING callback.
    Result<> open(const UA_KeyValueMap* parameters, const Application& application);
    /// Takes `buffer` over in every case.
    UA_StatusCode send(ConnectionId id, UA_ByteString* buffer);
    UA_StatusCode close(ConnectionId id);
    /// Closes the connections that were opened from here, and what their peers have not taken yet
    /// is never delivered.
    void dropOpened();

    void start();
    /// Closes everything; calls stopped() once the last application was notified.
    void stop();
    bool stopped() const;

    /// Has the stack look again at what it read but did not process.
    ///
    /// A client's answer to a synchronous call ends the processing of what was read with it. The
    /// stack means to continue by itself, but in 1.4.11.1 does so only before the session is open
    /// (fixed by 1.4.18), so a notification read together with an answer would wait for the next
    /// message, mostly one publishing interval.
    /// \return whether there was something to look at
    bool deliverLeftovers();

    /// Reads from the connection whose turn it is, and has the stack process the data.
    /// \return whether there was one
    bool takeTurn();
    std::chrono::nanoseconds workOnTurn() const;
    bool turnsWait() const { return !turns_.empty(); }

    void vouchFor(ConnectionId id);
    void admit(ConnectionId id);
    void dismiss(ConnectionId id);

    ConnectionId currentAccepted() const { return current_accepted_; }
    /// The loop's own figures are 0.
    EventLoopStatistics statistics() const;
    std::vector<ListenAddress> listening() const;
    const std::string& lastError() const { return last_error_; }

private:
    using Endpoints = std::vector<asio::ip::tcp::endpoint>;

    Connection* find(ConnectionId id);
    Connection& add(asio::ip::tcp::socket socket, const Application& application, Origin origin);
    void tell(Connection& connection, UA_ConnectionState state, const UA_KeyValueMap& parameters,
              UA_ByteString message);

    Result<> listen(const TcpParameters& parameters, const Application& application);
    void announce(OpenAcceptor open, const Application& application);
    void accept(Listener& listener);
    void onAccepted(ConnectionId id, const asio::error_code& error, asio::ip::tcp::socket socket);
    void startAccepted(Listener& listener, asio::ip::tcp::socket socket);

    void connect(const TcpParameters& parameters, const Application& application);
    void limitConnecting(Connection& connection, const std::string& target);
    void resolve(ConnectionId id, const TcpParameters& parameters);
    void tryNext(ConnectionId id, Endpoints endpoints, const std::string& target);
    void onConnected(ConnectionId id);

    void awaitReadable(Connection& connection);
    void readFrom(Connection& connection);
    void hear(Connection& connection, std::span<std::uint8_t> bytes);
    void deliver(Connection& connection, std::span<std::uint8_t> bytes);
    void awaitWritable(Connection& connection);
    void onWritable(ConnectionId id);
    void watchStall(Connection& connection, SteadyTime progress);

    bool isFull() const { return connections_.size() - closing_ >= options_.max_connections; }
    void makeRoom();
    Connection* mostExpendable();
    void beginAsStranger(Connection& connection);
    void limitPatience(Connection& connection);
    void drop(Connection& connection, const char* reason);

    void closeLater(Connection& connection);
    void closeListener(Listener& listener);
    void cut(Connection& connection, const char* reason);
    void finish(ConnectionId id);
    void finishListener(ConnectionId id);
    void note(std::string error);

    UA_ConnectionManager handle_{};
    Reactor& reactor_;
    Publisher& publisher_;
    const EventLoopOptions& options_;
    asio::ip::tcp::resolver resolver_;
    // By pointer: the stack keeps the address of a context, and callbacks open connections.
    std::unordered_map<ConnectionId, std::unique_ptr<Connection>> connections_;
    std::unordered_map<ConnectionId, std::unique_ptr<Listener>> listeners_;
    std::vector<ConnectionId> leftovers_;
    FairQueue turns_;
    std::optional<std::chrono::nanoseconds> turn_began_;  // in the thread's CPU time
    std::size_t closing_ = 0;                             // connections
    std::minstd_rand chance_;
    std::vector<std::uint8_t> receive_buffer_;
    ConnectionId last_id_ = 0;
    ConnectionId current_accepted_ = 0;
    std::string last_error_;
    EventLoopStatistics counts_;
};

}  // namespace metier::opcua
