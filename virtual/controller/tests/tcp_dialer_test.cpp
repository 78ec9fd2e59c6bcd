#include "metier/virtual_controller/tcp_dialer.hpp"

#include <gmock/gmock.h>

#include <array>
#include <asio/post.hpp>
#include <atomic>
#include <chrono>
#include <future>
#include <string>
#include <string_view>
#include <thread>

#include "metier/link/tcp_link.hpp"

namespace metier::virtual_controller {
namespace {

using namespace std::chrono_literals;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

/// Echoes what it gets over the connections it makes, on a thread of its own.
class DiallingEcho {
public:
    explicit DiallingEcho(std::uint16_t port) {
        dialer_ =
            TcpDialer::create(
                context_, {"127.73.2.1", "127.0.0.1", port}, faults,
                {.peer = {.on_connected = {},
                          .on_data = [](TcpPeer& peer, auto bytes) { peer.send(bytes); },
                          .on_closed = [this](TcpPeer&) { closed_.set_value(); }},
                 .on_failed = [this](const Error& error) { failed_.set_value(error.message); }})
                .value();
        thread_ = std::jthread([this](const std::stop_token& stop) {
            const std::stop_callback end(stop, [this] { context_.stop(); });
            context_.run();
        });
    }

    void dial() {
        asio::post(context_, [this] { dialer_->dial(); });
    }
    void reset() {
        asio::post(context_, [this] { dialer_->reset(); });
    }
    bool closes() { return closed_.get_future().wait_for(5s) == std::future_status::ready; }
    std::string failure() {
        auto future = failed_.get_future();
        return future.wait_for(5s) == std::future_status::ready ? future.get() : "none";
    }

    LinkFaults faults;

private:
    std::promise<void> closed_;
    std::promise<std::string> failed_;
    asio::io_context context_;
    asio::executor_work_guard<asio::io_context::executor_type> work_ =
        asio::make_work_guard(context_);
    std::unique_ptr<TcpDialer> dialer_;
    std::jthread thread_;
};

std::string echoOf(link::TcpLink& link, std::string_view text) {
    EXPECT_TRUE(link.send(std::as_bytes(std::span(text)), in(5s)));
    std::string answer(text.size(), '\0');
    const auto received = link.receiveAll(std::as_writable_bytes(std::span(answer)), in(5s));
    return received ? answer : std::string(toString(received.error().code));
}

TEST(TcpDialer, DialsFromItsOwnAddress) {
    auto listener = link::TcpListener::listen("127.0.0.1", 0).value();
    DiallingEcho echo(listener.port());
    echo.dial();
    auto link = listener.accept(in(5s)).value();
    EXPECT_THAT(link.peer(), ::testing::StartsWith("127.73.2.1:"));
    EXPECT_EQ(echoOf(link, "hello"), "hello");
}

TEST(TcpDialer, TellsThatNobodyAnswers) {
    DiallingEcho echo(1);
    echo.dial();
    EXPECT_THAT(echo.failure(), ::testing::StartsWith("127.0.0.1:1"));
}

TEST(TcpDialer, ReachesNobodyOverACutCable) {
    auto listener = link::TcpListener::listen("127.0.0.1", 0).value();
    DiallingEcho echo(listener.port());
    echo.faults.cut = true;
    echo.dial();
    EXPECT_THAT(echo.failure(), ::testing::HasSubstr("no answer"));
}

TEST(TcpDialer, ObeysTheFaultsOfItsCable) {
    auto listener = link::TcpListener::listen("127.0.0.1", 0).value();
    DiallingEcho echo(listener.port());
    echo.dial();
    auto link = listener.accept(in(5s)).value();
    echo.faults.garble = 1;
    EXPECT_NE(echoOf(link, "clean"), "clean");
    EXPECT_EQ(echoOf(link, "clean"), "clean");
}

TEST(TcpDialer, ResetsWhatIsConnected) {
    auto listener = link::TcpListener::listen("127.0.0.1", 0).value();
    DiallingEcho echo(listener.port());
    echo.dial();
    auto link = listener.accept(in(5s)).value();
    EXPECT_EQ(echoOf(link, "hello"), "hello");
    echo.reset();
    EXPECT_TRUE(echo.closes());
    std::array<std::byte, 1> nothing{};
    EXPECT_EQ(link.receive(nothing, in(5s)).error().code, Errc::connection_lost);
}

TEST(TcpDialer, RefusesWhatIsNoAddress) {
    asio::io_context context;
    LinkFaults faults;
    EXPECT_FALSE(TcpDialer::create(context, {"127.0.0.1", "the pc", 1}, faults, {}));
    EXPECT_FALSE(TcpDialer::create(context, {"127.0.0.1", "127.0.0.1", 0}, faults, {}));
}

}  // namespace
}  // namespace metier::virtual_controller
