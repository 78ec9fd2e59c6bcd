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

/// Memory for the pending operations of one direction, so that none of them allocates.
class OperationMemory {
public:
    void* take(std::size_t size) {
        for (auto& block : blocks_) {
            if (!block.used && size <= block.bytes.size()) {
                block.used = true;
                return block.bytes.data();
            }
        }
        return ::operator new(size);
    }

    void giveBack(void* memory) noexcept {
        for (auto& block : blocks_) {
            if (memory == block.bytes.data()) {
                block.used = false;
                return;
            }
        }
        ::operator delete(memory);
    }

private:
    struct Block {
        alignas(std::max_align_t) std::array<std::byte, 2048> bytes;
        bool used = false;
    };
    std::array<Block, 4> blocks_{};
};

template <typename T>
class OperationAllocator {
public:
    using value_type = T;
    explicit OperationAllocator(OperationMemory& memory) noexcept : memory_(&memory) {}
    template <typename U>
    OperationAllocator(const OperationAllocator<U>& other) noexcept  // NOLINT: as allocators are
        : memory_(other.memory_) {}

    T* allocate(std::size_t count) { return static_cast<T*>(memory_->take(count * sizeof(T))); }
    void deallocate(T* memory, std::size_t) noexcept { memory_->giveBack(memory); }
    template <typename U>
    bool operator==(const OperationAllocator<U>& other) const noexcept {
        return memory_ == other.memory_;
    }

private:
    template <typename U>
    friend class OperationAllocator;
    OperationMemory* memory_;
};

/// One direction of the link: at most one operation at a time.
struct Direction {
    OperationMemory memory{};
    bool pending = false;
    error_code error{};
};

/// Notes how an operation ended.
struct Ended {
    using allocator_type = OperationAllocator<std::byte>;

    Direction* direction;

    // NOLINTNEXTLINE(readability-identifier-naming): so Asio asks for it
    allocator_type get_allocator() const noexcept { return allocator_type(direction->memory); }
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
