#include "rosbridge_server.hpp"

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <thread>
#include <utility>

namespace metier::edo_driver::testing {
namespace {

namespace net = boost::asio;
using Tcp = net::ip::tcp;
using boost::system::error_code;

}  // namespace

// Everything but the public functions runs on its thread.
struct RosbridgeServer::Impl {
    struct Peer {
        explicit Peer(Tcp::socket socket) : stream(std::move(socket)) {}
        boost::beast::websocket::stream<Tcp::socket> stream;
        boost::beast::flat_buffer buffer;
        std::deque<std::string> outgoing;
        bool open = false;
    };

    Impl(Received on_text, Tick on_tick, std::chrono::milliseconds every)
        : received(std::move(on_text)), tick(std::move(on_tick)), period(every) {
        accept();
        thread = std::jthread([this] { context.run(); });
    }

    ~Impl() { context.stop(); }

    void accept() {
        acceptor.async_accept([this](error_code error, Tcp::socket socket) {
            if (error) {
                return;
            }
            socket.set_option(Tcp::no_delay(true));
            auto next = std::make_shared<Peer>(std::move(socket));
            next->stream.async_accept([this, next](error_code failed) {
                if (!failed) {
                    begin(next);
                }
            });
            accept();
        });
    }

    void begin(const std::shared_ptr<Peer>& next) {
        peer = next;
        peer->open = true;
        ++connections;
        read(next);
        due = std::chrono::steady_clock::now();
        wait(next);
    }

    void read(const std::shared_ptr<Peer>& from) {
        from->stream.async_read(from->buffer, [this, from](error_code error, std::size_t) {
            if (error) {
                from->open = false;
                return;
            }
            const auto text = boost::beast::buffers_to_string(from->buffer.data());
            from->buffer.consume(from->buffer.size());
            received(text);
            read(from);
        });
    }

    void wait(const std::shared_ptr<Peer>& of) {
        due += period;
        timer.expires_at(due);
        timer.async_wait([this, of](error_code error) {
            if (!error && of->open && of == peer) {
                tick();
                wait(of);
            }
        });
    }

    void write(const std::shared_ptr<Peer>& to) {
        to->stream.text(true);
        to->stream.async_write(net::buffer(to->outgoing.front()),
                               [this, to](error_code error, std::size_t) {
                                   to->outgoing.pop_front();
                                   if (!error && !to->outgoing.empty()) {
                                       write(to);
                                   }
                               });
    }

    void push(std::string text) {
        if (peer && peer->open) {
            peer->outgoing.push_back(std::move(text));
            if (peer->outgoing.size() == 1) {
                write(peer);
            }
        }
    }

    void close() {
        if (peer) {
            error_code ignored;
            peer->open = false;
            peer->stream.next_layer().close(ignored);
        }
    }

    Received received;
    Tick tick;
    std::chrono::milliseconds period;
    std::chrono::steady_clock::time_point due;
    net::io_context context{1};
    Tcp::acceptor acceptor{context, Tcp::endpoint(net::ip::address_v4::loopback(), 0)};
    net::steady_timer timer{context};
    std::shared_ptr<Peer> peer;  // shared with its pending operations
    std::atomic<int> connections{0};
    std::jthread thread;
};

RosbridgeServer::RosbridgeServer(Received received, Tick tick, std::chrono::milliseconds period)
    : impl_(std::make_unique<Impl>(std::move(received), std::move(tick), period)) {}

RosbridgeServer::~RosbridgeServer() = default;

std::uint16_t RosbridgeServer::port() const {
    return impl_->acceptor.local_endpoint().port();
}

void RosbridgeServer::send(std::string text) {
    net::post(impl_->context, [impl = impl_.get(), text = std::move(text)] { impl->push(text); });
}

void RosbridgeServer::ping() {
    net::post(impl_->context, [impl = impl_.get()] {
        if (impl->peer && impl->peer->open) {
            impl->peer->stream.async_ping({}, [](error_code) {});
        }
    });
}

void RosbridgeServer::drop() {
    net::post(impl_->context, [impl = impl_.get()] { impl->close(); });
}

int RosbridgeServer::connections() const {
    return impl_->connections.load();
}

}  // namespace metier::edo_driver::testing
