#include "metier/virtual_controller/tcp_server.hpp"

#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "metier/link/tcp_link.hpp"

namespace metier::virtual_controller {
namespace {

using namespace std::chrono_literals;
using link::TcpLink;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

/// Echoes what it gets, on a thread of its own as a controller has.
class Echo {
public:
    Echo() {
        server_ = TcpServer::listen(context_, {"127.0.0.1", 0}, faults,
                                    {.on_connected = [this](TcpPeer&) { ++connected; },
                                     .on_data = [](TcpPeer& peer, auto bytes) { peer.send(bytes); },
                                     .on_closed = [this](TcpPeer&) { ++closed; }})
                      .value();
        port = server_->port();
        thread_ = std::jthread([this](const std::stop_token& stop) {
            const std::stop_callback end(stop, [this] { context_.stop(); });
            context_.run();
        });
    }

    TcpLink connect() { return TcpLink::connect("127.0.0.1", port, in(5s)).value(); }
    /// Waits until the server has seen who dialled before: its thread looks for events between two
    /// actions, and handles in the next turn what it found.
    void awaitAccept() {
        for (int i = 0; i < 4; ++i) {
            inTurn([](TcpServer&) {});
        }
    }
    /// Runs on the controller's thread, and waits for it.
    void inTurn(const std::function<void(TcpServer&)>& action) {
        std::atomic<bool> done{false};
        asio::post(context_, [&] {
            action(*server_);
            done.store(true);
            done.notify_all();
        });
        done.wait(false);
    }

    LinkFaults faults;
    std::uint16_t port = 0;
    std::atomic<int> connected{0};
    std::atomic<int> closed{0};

private:
    asio::io_context context_;
    std::unique_ptr<TcpServer> server_;
    std::jthread thread_;
};

std::string echoOf(TcpLink& link, std::string_view text, std::chrono::milliseconds within = 5s) {
    EXPECT_TRUE(link.send(std::as_bytes(std::span(text)), in(5s)));
    std::string answer(text.size(), '\0');
    const auto received = link.receiveAll(std::as_writable_bytes(std::span(answer)), in(within));
    return received ? answer : std::string(toString(received.error().code));
}

TEST(TcpServer, ServesSeveralPeers) {
    Echo echo;
    auto first = echo.connect();
    auto second = echo.connect();
    EXPECT_EQ(echoOf(first, "one"), "one");
    EXPECT_EQ(echoOf(second, "two"), "two");
    EXPECT_EQ(echo.connected, 2);
}

TEST(TcpServer, IsSilentWhileTheCableIsCut) {
    Echo echo;
    auto link = echo.connect();
    EXPECT_EQ(echoOf(link, "before"), "before");
    echo.faults.cut = true;
    EXPECT_EQ(echoOf(link, "lost", 50ms), "timeout");
}

TEST(TcpServer, SendsLaterByTheDelay) {
    Echo echo;
    auto link = echo.connect();
    echo.faults.delay_ms = 60;
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(echoOf(link, "late"), "late");
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 60ms);
}

TEST(TcpServer, ChangesAByteOfAsManyPacketsAsAreToBeGarbled) {
    Echo echo;
    auto link = echo.connect();
    echo.faults.garble = 1;
    EXPECT_NE(echoOf(link, "clean"), "clean");
    EXPECT_EQ(echoOf(link, "clean"), "clean");
}

TEST(TcpServer, ResetsEveryPeer) {
    Echo echo;
    auto link = echo.connect();
    EXPECT_EQ(echoOf(link, "here"), "here");
    echo.inTurn([](TcpServer& server) { server.resetAll(); });
    std::array<std::byte, 1> nothing{};
    EXPECT_EQ(link.receive(nothing, in(5s)).error().code, Errc::connection_lost);
    echo.inTurn([](TcpServer&) {});
    EXPECT_EQ(echo.closed, 1);
}

TEST(TcpServer, SendsWhatIsQueuedBeforeItCloses) {
    Echo echo;
    auto link = echo.connect();
    EXPECT_EQ(echoOf(link, "x"), "x");
    echo.inTurn([](TcpServer& server) {
        server.forEach([](TcpPeer& peer) {
            peer.send("goodbye");
            peer.close();
        });
    });
    std::array<char, 7> word{};
    ASSERT_TRUE(link.receiveAll(std::as_writable_bytes(std::span(word)), in(5s)));
    EXPECT_EQ(std::string_view(word.data(), word.size()), "goodbye");
    std::array<std::byte, 1> more{};
    EXPECT_EQ(link.receive(more, in(5s)).error().code, Errc::connection_lost);
}

TEST(TcpServer, SeesAPeerGo) {
    Echo echo;
    {
        auto link = echo.connect();
        EXPECT_EQ(echoOf(link, "x"), "x");
    }
    while (echo.closed == 0) {
        echo.inTurn([](TcpServer&) {});
    }
    EXPECT_EQ(echo.closed, 1);
}

TEST(TcpServer, DropsAPeerThatLeavesMoreThanAMegabyteUnread) {
    Echo echo;
    auto link = echo.connect();
    EXPECT_EQ(echoOf(link, "x"), "x");
    const std::vector<std::byte> megabyte(1'000'000);
    const auto sendAndCount = [&](std::span<const std::byte> bytes) {
        std::size_t queued = 0;
        echo.inTurn([&](TcpServer& server) {
            server.forEach([&](TcpPeer& peer) {
                peer.send(bytes);
                queued = peer.queued();
            });
        });
        return queued;
    };
    const auto deadline = in(10s);
    while (sendAndCount({}) > 0) {  // the echo may have come before the server noted it as sent
        ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    }
    echo.faults.delay_ms = 10'000;  // nothing leaves the queue
    EXPECT_EQ(sendAndCount(megabyte), 1'000'000U);
    echo.faults.cut = true;
    EXPECT_EQ(sendAndCount(std::span(megabyte).first(1)), 1'000'000U) << "lost in the cable";
    echo.faults.cut = false;
    EXPECT_EQ(echo.closed, 0);
    sendAndCount(std::span(megabyte).first(1));
    std::array<std::byte, 1> nothing{};
    EXPECT_EQ(link.receive(nothing, in(5s)).error().code, Errc::connection_lost);
    echo.inTurn([](TcpServer&) {});
    EXPECT_EQ(echo.closed, 1);
}

TEST(TcpServer, NeverServesAPeerThatDialledOverACutCable) {
    Echo echo;
    echo.faults.cut = true;
    auto cut_off = echo.connect();
    echo.awaitAccept();
    EXPECT_EQ(echoOf(cut_off, "hello", 50ms), "timeout");
    echo.faults.cut = false;
    auto link = echo.connect();
    EXPECT_EQ(echoOf(link, "hello"), "hello");
    EXPECT_EQ(echo.connected, 1);
    std::array<std::byte, 1> nothing{};
    EXPECT_EQ(cut_off.receive(nothing, in(5s)).error().code, Errc::connection_lost);
}

TEST(TcpServer, TakesNoPeerOnceItIsGone) {
    asio::io_context context;
    LinkFaults faults;
    int connected = 0;
    std::unique_ptr<TcpServer> server;
    server = TcpServer::listen(context, {"127.0.0.1", 0}, faults,
                               {.on_connected =
                                    [&](TcpPeer&) {
                                        ++connected;
                                        asio::post(context, [&] { server.reset(); });
                                    },
                                .on_data = {},
                                .on_closed = {}})
                 .value();
    const auto first = TcpLink::connect("127.0.0.1", server->port(), in(5s));
    const auto second = TcpLink::connect("127.0.0.1", server->port(), in(5s));
    ASSERT_TRUE(first && second);
    context.run_for(10s);
    EXPECT_FALSE(server);
    EXPECT_EQ(connected, 1);
}

TEST(TcpServer, RefusesAPortThatIsTaken) {
    Echo echo;
    asio::io_context context;
    const auto second = TcpServer::listen(context, {"127.0.0.1", echo.port}, echo.faults, {});
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::already_exists);
}

TEST(TcpServer, RefusesAnAddressThatIsNotOfThisMachine) {
    asio::io_context context;
    LinkFaults faults;
    for (const auto* address : {"192.0.2.1", "the robot", ""}) {
        const auto server = TcpServer::listen(context, {address, 0}, faults, {});
        ASSERT_FALSE(server) << address;
        EXPECT_EQ(server.error().code, Errc::invalid_argument) << address;
    }
}

}  // namespace
}  // namespace metier::virtual_controller
