#pragma once

#include <atomic>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "metier/base/error.hpp"
#include "metier/http/http_limits.hpp"
#include "metier/http/httplib.hpp"

namespace metier::http {

class Connection;

/// httplib's server with limits: number of connections, size and time of a request, and time for
/// which a client may not read. One thread for each open connection. A body that no handler has
/// read is skipped: it is never taken for another request.
///
/// Set all routes before serve(). Threading: handlers run on the connections' threads.
///
///     HttpServer http{HttpLimits{}};
///     http.Get("/metrics", [&](const auto&, auto& response) { ... });
///     const auto port = http.serve("127.0.0.1", 0);   // a free one
///     ...
///     http.end();
class HttpServer final : public httplib::Server {
public:
    /// \param limits for all clients together; nothing is open yet
    explicit HttpServer(const HttpLimits& limits);
    /// Call end() before, once serve() has succeeded.
    ~HttpServer() override;

    /// Opens the port and serves from then on. Call it once.
    /// \param address IP address of this machine
    /// \param port    0: a free one
    /// \return the port
    /// Errors: already_exists (the port is taken, or the address is not one of this machine).
    Result<std::uint16_t> serve(const std::string& address, std::uint16_t port);
    /// Ends all connections at once and waits for their threads. Call it once.
    /// Handlers that are under way are not interrupted: one that waits makes this wait.
    void end();

private:
    /// Called by httplib for each new connection: on a thread of its own, or, if all threads have a
    /// connection, on the accepting one, which refuses it.
    bool process_and_close_socket(int socket) override;
    /// Serves requests until the client closes, breaks a limit, or the server ends.
    void converse(Connection& connection);
    template <typename Self>
    static bool serveOne(Self& self, Connection& connection, bool& closed);
    /// Answers a connection beyond HttpLimits::connections with 503; does not wait for its peer.
    static void refuse(int socket);

    const HttpLimits limits_;
    std::atomic<bool> ending_ = false;
    std::atomic<bool> listened_ = false;  // serving has begun and ended again
    std::mutex mutex_;
    std::set<int> sockets_;
    // The thread of accepting_, which end() moves while connections look who accepts.
    std::atomic<std::thread::id> acceptor_;
    std::jthread accepting_;
};

}  // namespace metier::http
