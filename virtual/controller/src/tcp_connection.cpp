#include "tcp_connection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <asio/buffer.hpp>
#include <asio/execution/context.hpp>
#include <asio/query.hpp>
#include <asio/write.hpp>
#include <chrono>
#include <utility>

namespace metier::virtual_controller {

using asio::ip::tcp;

asio::execution_context::id OpenConnections::id;

namespace {

constexpr std::size_t kLongestQueue = 1'000'000;
// A cut cable is looked at so often.
constexpr std::chrono::milliseconds kCutPause{10};

}  // namespace

// ---- owner -------------------------------------------------------------------------------------

TcpConnectionOwner::~TcpConnectionOwner() {
    if (open_ != nullptr) {
        open_->count -= peers_.size();
    }
    for (const auto& peer : peers_) {
        peer->abandon();
    }
}

void TcpConnectionOwner::take(tcp::socket socket) {
    asio::error_code error;
    const auto remote = socket.remote_endpoint(error);
    if (error) {
        return;
    }
    socket.set_option(tcp::no_delay(true), error);
    const auto executor = socket.get_executor();
    auto peer = std::make_shared<TcpConnection>(
        *this, std::move(socket),
        fmt::format("{}:{}", remote.address().to_string(), remote.port()));
    peers_.push_back(peer);
    open_ = &OpenConnections::of(asio::query(executor, asio::execution::context));
    ++open_->count;
    if (handlers.on_connected) {
        handlers.on_connected(*peer);
    }
    peer->read();
}

void TcpConnectionOwner::remove(const TcpConnection* peer) {
    const auto found = std::find_if(peers_.begin(), peers_.end(),
                                    [&](const auto& known) { return known.get() == peer; });
    if (found != peers_.end()) {
        const auto kept = *found;  // until the handler returns
        peers_.erase(found);
        --open_->count;
        if (handlers.on_closed) {
            handlers.on_closed(*kept);
        }
    }
}

void TcpConnectionOwner::forEachPeer(const std::function<void(TcpPeer&)>& action) {
    const auto peers = peers_;  // an action may close one
    for (const auto& peer : peers) {
        action(*peer);
    }
}

// ---- connection --------------------------------------------------------------------------------

TcpConnection::TcpConnection(TcpConnectionOwner& owner, tcp::socket socket, std::string address)
    : owner_(&owner),
      socket_(std::move(socket)),
      write_timer_(socket_.get_executor()),
      read_timer_(socket_.get_executor()),
      address_(std::move(address)) {}

void TcpConnection::send(std::span<const std::byte> bytes) {
    if (closing_ || owner_ == nullptr || bytes.empty()) {
        return;
    }
    auto& faults = owner_->faults;
    if (queued_ + bytes.size() > kLongestQueue) {
        if (!faults.cut.load()) {
            reset();
        }
        return;
    }
    const auto delay = std::chrono::milliseconds(faults.delay_ms.load());
    outgoing_.push_back({std::chrono::steady_clock::now() + delay, {bytes.begin(), bytes.end()}});
    queued_ += bytes.size();
    faults.spoil(outgoing_.back().bytes);
    write();
}

void TcpConnection::writeAt(SteadyTime until) {
    write_timer_.expires_at(until);
    write_timer_.async_wait([self = shared_from_this()](const asio::error_code& error) {
        self->writing_ = false;
        if (!error) {
            self->write();
        }
    });
}

void TcpConnection::write() {
    if (writing_ || owner_ == nullptr) {
        return;
    }
    if (outgoing_.empty()) {
        if (closing_) {
            lose();
        }
        return;
    }
    writing_ = true;
    const auto now = std::chrono::steady_clock::now();
    if (owner_->faults.cut.load()) {
        writeAt(now + kCutPause);
    } else if (outgoing_.front().due > now) {
        writeAt(outgoing_.front().due);
    } else {
        writeFront();
    }
}

void TcpConnection::writeFront() {
    const auto& bytes = outgoing_.front().bytes;
    asio::async_write(socket_, asio::buffer(bytes.data(), bytes.size()),
                      [self = shared_from_this()](const asio::error_code& error, std::size_t) {
                          self->writing_ = false;
                          if (error) {
                              self->lose();
                              return;
                          }
                          self->queued_ -= self->outgoing_.front().bytes.size();
                          self->outgoing_.pop_front();
                          self->write();
                      });
}

void TcpConnection::read() {
    if (owner_ == nullptr) {
        return;
    }
    if (owner_->faults.cut.load()) {
        read_timer_.expires_after(kCutPause);
        read_timer_.async_wait([self = shared_from_this()](const asio::error_code& error) {
            if (!error) {
                self->read();
            }
        });
        return;
    }
    socket_.async_read_some(
        asio::buffer(incoming_.data(), incoming_.size()),
        [self = shared_from_this()](const asio::error_code& error, std::size_t count) {
            self->onRead(error, count);
        });
}

void TcpConnection::onRead(const asio::error_code& error, std::size_t count) {
    if (error) {
        lose();
        return;
    }
    if (owner_ == nullptr) {
        return;
    }
    // Bytes that come over a cut cable are lost.
    if (!owner_->faults.cut.load() && owner_->handlers.on_data) {
        owner_->handlers.on_data(*this, std::span(incoming_).first(count));
    }
    if (socket_.is_open()) {
        read();
    }
}

void TcpConnection::close() {
    closing_ = true;
    if (!writing_ && outgoing_.empty()) {
        // Not from within a handler of this peer's own data.
        asio::post(socket_.get_executor(), [self = shared_from_this()] { self->lose(); });
    }
}

void TcpConnection::reset() {
    asio::error_code ignored;
    socket_.set_option(asio::socket_base::linger(true, 0), ignored);
    closing_ = true;
    closeSocket();
    asio::post(socket_.get_executor(), [self = shared_from_this()] { self->lose(); });
}

void TcpConnection::abandon() {
    owner_ = nullptr;
    closeSocket();
}

void TcpConnection::closeSocket() {
    asio::error_code ignored;
    socket_.close(ignored);
    write_timer_.cancel();
    read_timer_.cancel();
}

void TcpConnection::lose() {
    closeSocket();
    if (auto* owner = std::exchange(owner_, nullptr)) {
        owner->remove(this);
    }
}

}  // namespace metier::virtual_controller
