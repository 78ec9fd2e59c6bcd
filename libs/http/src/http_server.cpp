#include "metier/http/http_server.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <optional>
#include <string_view>

#include "connection.hpp"
#include "metier/base/text.hpp"
#include "workers.hpp"

namespace metier::http {
namespace {

constexpr std::string_view kFull =
    "HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/json\r\nConnection: close\r\n"
    "Content-Length: 85\r\n\r\n"
    R"({"error":{"code":"resource_unavailable","message":"too many connections; try later"}})";

/// httplib would unpack a body to a thousand times its size, and answer many ranges of a file with
/// as many copies of it. Without a length it would wait for a body until the peer has gone.
void forgetExtras(httplib::Request& request) {
    if (!request.has_header("Content-Length") && !request.has_header("Transfer-Encoding")) {
        request.headers.emplace("Content-Length", "0");
    }
    request.headers.erase("Content-Encoding");
    request.headers.erase("Range");
    request.ranges.clear();
}

/// How long the body is that follows a head [byte]; none: it does not say for certain, and what is
/// read as the next request might be a part of it, which somebody else wrote.
std::optional<std::size_t> bodyLength(const httplib::Request& request) {
    const auto lengths = request.get_header_value_count("Content-Length");
    if (request.has_header("Transfer-Encoding") || lengths > 1) {
        return std::nullopt;
    }
    return lengths == 0 ? 0 : numberIn<std::size_t>(request.get_header_value("Content-Length"));
}

/// A port that is taken is refused; what is sent waits here, not in the system.
void setOptions(int socket) {
    const int yes = 1;
    const int send_buffer = 262'144;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &send_buffer, sizeof send_buffer);
}

}  // namespace

HttpServer::HttpServer(const HttpLimits& limits) : limits_(limits) {
    new_task_queue = [most = limits.connections] { return new Workers(most); };  // NOLINT: taken
    set_socket_options(&setOptions);
    set_tcp_nodelay(true);
    set_payload_max_length(limits.body_bytes);
}

HttpServer::~HttpServer() = default;

Result<std::uint16_t> HttpServer::serve(const std::string& address, std::uint16_t port) {
    const int bound = port == 0 ? bind_to_any_port(address)
                                : (bind_to_port(address, port) ? static_cast<int>(port) : -1);
    if (bound <= 0) {
        return fail(Errc::already_exists,
                    fmt::format("cannot serve at {}, port {}: the port is taken, or the address is "
                                "not one of this machine",
                                address, port));
    }
    accepting_ = std::jthread([this] {
        acceptor_ = std::this_thread::get_id();
        listen_after_bind();
        listened_ = true;
    });
    return static_cast<std::uint16_t>(bound);
}

void HttpServer::end() {
    ending_ = true;
    while (accepting_.joinable() && !is_running() && !listened_) {
        std::this_thread::yield();  // stop() is lost on a server that does not listen yet
    }
    {
        const std::lock_guard lock(mutex_);
        for (const int socket : sockets_) {
            ::shutdown(socket, SHUT_RDWR);
        }
    }
    stop();
    accepting_ = {};
}

void HttpServer::refuse(int socket) {
    // Nobody waits for this peer: what does not go out at once does not.
    static_cast<void>(send(socket, kFull.data(), kFull.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
    ::shutdown(socket, SHUT_WR);
}

template <typename Self>
bool HttpServer::serveOne(Self& self, Connection& connection, bool& closed) {
    const std::function<void(httplib::Request&)> on_head =
        [&connection](httplib::Request& request) {
            connection.beginBody(bodyLength(request));
            forgetExtras(request);
        };
    if constexpr (requires { self.process_request(connection, false, closed, on_head); }) {
        return self.process_request(connection, self.ending_, closed, on_head);
    } else {
        std::string remote;
        std::string local;
        int remote_port = 0;
        int local_port = 0;
        connection.get_remote_ip_and_port(remote, remote_port);
        connection.get_local_ip_and_port(local, local_port);
        return self.process_request(connection, remote, remote_port, local, local_port,
                                    self.ending_, closed, on_head);
    }
}

void HttpServer::converse(Connection& connection) {
    bool closed = false;
    while (!ending_ && connection.awaitRequest()) {
        connection.beginRequest();
        if (!serveOne(*this, connection, closed) || closed || !connection.endRequest()) {
            return;
        }
    }
}

bool HttpServer::process_and_close_socket(int socket) {
    if (std::this_thread::get_id() == acceptor_.load()) {
        refuse(socket);  // every thread has a connection
    } else {
        {
            const std::lock_guard lock(mutex_);
            sockets_.insert(socket);
        }
        Connection connection(socket, limits_);
        converse(connection);
        const std::lock_guard lock(mutex_);
        sockets_.erase(socket);
    }
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return true;
}

}  // namespace metier::http
