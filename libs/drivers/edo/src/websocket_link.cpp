// The only file that knows Boost.
#include "metier/edo_driver/websocket_link.hpp"

#include <fmt/format.h>
#include <sys/socket.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <cstddef>
#include <memory_resource>
#include <utility>
#include <vector>

#include "metier/link/host_addresses.hpp"

namespace metier::edo_driver {
namespace {

namespace beast = boost::beast;
using Tcp = boost::asio::ip::tcp;
using Executor = boost::asio::io_context::executor_type;
using Socket = boost::asio::basic_stream_socket<Tcp, Executor>;
using Stream = beast::websocket::stream<Socket, false>;  // without compression
using boost::system::error_code;

constexpr std::size_t kLongestMessage = std::size_t{1} << 20U;
constexpr std::size_t kUsualMessage = std::size_t{1} << 16U;

/// One direction of the link: at most one operation at a time.
struct Direction {
    // For its operation, so that the heap is not used.
    std::array<std::byte, std::size_t{1} << 15U> storage{};
    std::pmr::monotonic_buffer_resource buffer{storage.data(), storage.size()};
    std::pmr::unsynchronized_pool_resource memory{{4, 4096}, &buffer};
    bool pending = false;
    error_code error{};
};

/// Notes how an operation ended.
struct Ended {
    using allocator_type = std::pmr::polymorphic_allocator<std::byte>;

    Direction* direction;

    // NOLINTNEXTLINE(readability-identifier-naming): so Asio asks for it
    allocator_type get_allocator() const noexcept { return &direction->memory; }
    template <typename... Ignored>
    void operator()(error_code error, const Ignored&...) const noexcept {
        direction->error = error;
        direction->pending = false;
    }
};

Ended begin(Direction& direction) {
    direction.pending = true;
    return Ended{&direction};
}

}  // namespace

struct WebSocketLink::Impl {
    explicit Impl(std::string peer_name) : peer(std::move(peer_name)) {
        buffer.reserve(kUsualMessage);
    }

    /// Lets operations go on until that of `direction` ended.
    Result<void> finish(const Direction& direction, SteadyTime deadline) {
        while (direction.pending) {
            if (context.stopped()) {
                context.restart();
            }
            if (context.poll_one() == 0 && context.run_one_until(deadline) == 0 &&
                direction.pending) {
                return fail(Errc::timeout, peer + ": no answer in time");
            }
        }
        if (direction.error) {
            return fail(Errc::connection_lost, fmt::format("{}: {}", peer, lossText()));
        }
        return {};
    }

    std::string lossText() const {
        const auto& error = reader.error ? reader.error : writer.error;
        return error == beast::websocket::error::closed ? "the server closed the connection"
                                                        : error.message();
    }

    Result<void> open(const std::vector<Tcp::endpoint>& endpoints, SteadyTime deadline) {
        boost::asio::async_connect(stream.next_layer(), endpoints, begin(writer));
        METIER_TRY(finish(writer, deadline));
        error_code ignored;
        stream.next_layer().set_option(Tcp::no_delay(true), ignored);
        stream.async_handshake(peer, "/", begin(writer));
        METIER_TRY(finish(writer, deadline));
        stream.text(true);
        stream.auto_fragment(false);
        stream.read_message_max(kLongestMessage);
        return {};
    }

    std::string peer;
    Direction reader{};
    Direction writer{};
    boost::asio::io_context context{1};  // destroys what is pending, so before the directions
    Stream stream{context};
    beast::flat_buffer buffer{kLongestMessage};
    bool delivered = false;  // the content of the buffer was delivered
};

WebSocketLink::WebSocketLink(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
WebSocketLink::WebSocketLink(WebSocketLink&&) noexcept = default;
WebSocketLink& WebSocketLink::operator=(WebSocketLink&&) noexcept = default;
WebSocketLink::~WebSocketLink() = default;

Result<WebSocketLink> WebSocketLink::connect(const std::string& host, std::uint16_t port,
                                             SteadyTime deadline) {
    auto impl = std::make_unique<Impl>(fmt::format("{}:{}", host, port));
    const auto found = link::addressesOf(host, deadline);
    if (!found) {
        return fail(found.error().code, fmt::format("{}: {}", impl->peer, found.error().message));
    }
    std::vector<Tcp::endpoint> endpoints;
    for (const auto& address : *found) {
        endpoints.emplace_back(boost::asio::ip::make_address(address.to_string()), port);
    }
    METIER_TRY(impl->open(endpoints, deadline));
    return WebSocketLink(std::move(impl));
}

Result<void> WebSocketLink::send(std::string_view text, SteadyTime deadline) {
    auto& impl = *impl_;
    impl.stream.async_write(boost::asio::buffer(text.data(), text.size()), begin(impl.writer));
    auto sent = impl.finish(impl.writer, deadline);
    if (!sent) {
        shutdown();  // ends the link: part of the text may be sent already
        impl.finish(impl.writer, SteadyTime::max());
    }
    return sent;
}

Result<std::string_view> WebSocketLink::receive(SteadyTime deadline) {
    auto& impl = *impl_;
    if (impl.delivered) {
        impl.buffer.consume(impl.buffer.size());
        impl.delivered = false;
    }
    if (!impl.reader.pending) {
        if (impl.reader.error) {
            return fail(Errc::connection_lost, fmt::format("{}: {}", impl.peer, impl.lossText()));
        }
        impl.stream.async_read(impl.buffer, begin(impl.reader));
    }
    METIER_TRY(impl.finish(impl.reader, deadline));
    impl.delivered = true;
    const auto bytes = impl.buffer.cdata();
    return std::string_view(static_cast<const char*>(bytes.data()), bytes.size());
}

void WebSocketLink::shutdown() noexcept {
    ::shutdown(impl_->stream.next_layer().native_handle(), SHUT_RDWR);
}

const std::string& WebSocketLink::peer() const noexcept {
    return impl_->peer;
}

}  // namespace metier::edo_driver
