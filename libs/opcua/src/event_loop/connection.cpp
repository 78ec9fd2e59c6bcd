#include "connection.hpp"

#include <linux/sockios.h>
#include <netinet/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <asio/buffer.hpp>
#include <utility>

namespace metier::opcua {

namespace {

// TCP_RTO_MIN_US of Linux 6.15 and later; older headers lack the name.
constexpr int kTcpRtoMinUs = 45;
constexpr int kRepeatAfterUs = 50'000;  // above the 40 ms that Linux may hold back an answer

/// Makes the system repeat the packets of a connection with little traffic, such as heartbeats, 50
/// ms after a loss instead of 200 ms, and then at a steady pace for a while instead of ever more
/// slowly. Does nothing on systems without these options.
void repeatSoon(int socket) {
    const int on = 1;
    static_cast<void>(::setsockopt(socket, IPPROTO_TCP, TCP_THIN_LINEAR_TIMEOUTS, &on, sizeof(on)));
    static_cast<void>(
        ::setsockopt(socket, IPPROTO_TCP, kTcpRtoMinUs, &kRepeatAfterUs, sizeof(kRepeatAfterUs)));
}

}  // namespace

Connection::Connection(ConnectionId id, asio::ip::tcp::socket socket, Application application,
                       Origin origin)
    : connected(origin == Origin::accepted),
      id_(id),
      socket_(std::move(socket)),
      timer_(socket_.get_executor()),
      patience_(socket_.get_executor()),
      application_(application),
      origin_(origin) {}

asio::error_code Connection::configure(int send_buffer) {
    asio::error_code error;
    socket_.non_blocking(true, error);
    if (!error) {
        socket_.set_option(asio::ip::tcp::no_delay(true), error);
    }
    if (!error && send_buffer > 0) {
        socket_.set_option(asio::socket_base::send_buffer_size(send_buffer), error);
    }
    if (!error) {
        repeatSoon(socket_.native_handle());
    }
    return error;
}

std::size_t Connection::receive(std::span<std::uint8_t> buffer, asio::error_code& error) {
    return socket_.read_some(asio::buffer(buffer.data(), buffer.size()), error);
}

asio::error_code Connection::send(NetworkBuffer buffer) {
    const bool first = queue_.empty();
    queue_.push(std::move(buffer));
    return first ? writeQueued() : asio::error_code{};
}

asio::error_code Connection::writeQueued() {
    asio::error_code error;
    while (!queue_.empty()) {
        const auto bytes = queue_.front();
        const auto sent = socket_.write_some(asio::buffer(bytes.data(), bytes.size()), error);
        if (error == asio::error::would_block) {
            return {};
        }
        if (error) {
            return error;
        }
        written_ += sent;
        queue_.consume(sent);
    }
    return error;
}

bool Connection::progressed() {
    int unacknowledged = 0;
    if (::ioctl(socket_.native_handle(), SIOCOUTQ, &unacknowledged) != 0) {
        return false;
    }
    const auto now = written_ - static_cast<std::uint64_t>(unacknowledged);
    return std::exchange(acknowledged_, now) != now;
}

void Connection::close() {
    closing_ = true;
    asio::error_code ignored;  // nothing more can be done
    socket_.close(ignored);
    timer_.cancel();
    patience_.cancel();
    queue_.clear();
}

void Connection::forget() {
    asio::error_code ignored;  // it is closed whether this worked or not
    socket_.set_option(asio::socket_base::linger(true, 0), ignored);
}

}  // namespace metier::opcua
