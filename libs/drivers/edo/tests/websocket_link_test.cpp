#include "metier/edo_driver/websocket_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <thread>

#include "metier/base/testing/allocation_count.hpp"
#include "metier/link/tcp_link.hpp"
#include "rosbridge_server.hpp"

namespace metier::edo_driver {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using testing::RosbridgeServer;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

/// A server that keeps what it hears.
class WebSocketLinkTest : public ::testing::Test {
protected:
    WebSocketLink connected() {
        return std::move(WebSocketLink::connect("127.0.0.1", server_.port(), in(10s)).value());
    }

    std::string heard() {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, 20s, [this] { return !texts_.empty(); });
        if (texts_.empty()) {
            return "nothing";
        }
        auto text = texts_.front();
        texts_.pop_front();
        return text;
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::string> texts_;
    RosbridgeServer server_{[this](std::string_view text) {
                                const std::lock_guard lock(mutex_);
                                texts_.emplace_back(text);
                                changed_.notify_all();
                            },
                            [] {}, 10s};
};

TEST_F(WebSocketLinkTest, SendsAndReceivesTexts) {
    auto link = connected();
    ASSERT_TRUE(link.send(R"({"op":"subscribe"})", in(10s)));
    EXPECT_EQ(heard(), R"({"op":"subscribe"})");
    server_.send("first");
    server_.send("second");
    EXPECT_EQ(link.receive(in(10s)).value(), "first");
    EXPECT_EQ(link.receive(in(10s)).value(), "second");
}

TEST_F(WebSocketLinkTest, GoesOnAfterATimeout) {
    auto link = connected();
    EXPECT_EQ(link.receive(in(5ms)).error().code, Errc::timeout);
    EXPECT_EQ(link.receive(in(-1ms)).error().code, Errc::timeout);
    ASSERT_TRUE(link.send("still here", in(10s)));
    EXPECT_EQ(heard(), "still here");
    server_.send("late");
    EXPECT_EQ(link.receive(in(10s)).value(), "late");
}

TEST_F(WebSocketLinkTest, AnswersPings) {
    auto link = connected();
    ASSERT_TRUE(link.send("a", in(10s)));
    heard();
    server_.ping();
    server_.send("behind the ping");
    EXPECT_EQ(link.receive(in(10s)).value(), "behind the ping");
    ASSERT_TRUE(link.send("behind the pong", in(10s)));
    EXPECT_EQ(heard(), "behind the pong");
}

TEST_F(WebSocketLinkTest, TellsThatTheServerIsGone) {
    auto link = connected();
    ASSERT_TRUE(link.send("a", in(10s)));
    heard();
    server_.drop();
    const auto received = link.receive(in(10s));
    ASSERT_FALSE(received);
    EXPECT_EQ(received.error().code, Errc::connection_lost);
    EXPECT_THAT(received.error().message, HasSubstr("127.0.0.1:"));
    EXPECT_EQ(link.receive(in(10s)).error().code, Errc::connection_lost);
}

TEST(WebSocketLinkSend, GivesUpOnAPeerThatDoesNotRead) {
    std::promise<void> end;
    auto ended = end.get_future();
    RosbridgeServer server([&](std::string_view) { ended.wait(); }, [] {}, 10s);
    auto link = std::move(WebSocketLink::connect("127.0.0.1", server.port(), in(10s)).value());
    const std::string text(1U << 19U, 'x');
    Result<void> sent;
    for (int i = 0; i < 1000 && sent; ++i) {
        sent = link.send(text, in(50ms));
    }
    end.set_value();
    ASSERT_FALSE(sent);
    EXPECT_EQ(sent.error().code, Errc::timeout);
    EXPECT_EQ(link.send("more", in(10s)).error().code, Errc::connection_lost);
}

TEST_F(WebSocketLinkTest, AShutDownLinkTellsIt) {
    auto link = connected();
    link.shutdown();
    EXPECT_EQ(link.receive(in(10s)).error().code, Errc::connection_lost);
}

TEST_F(WebSocketLinkTest, RefusesAMessageOverOneMebibyte) {
    auto link = connected();
    ASSERT_TRUE(link.send("a", in(10s)));
    heard();
    server_.send(std::string((1U << 20U) + 1, 'x'));
    EXPECT_EQ(link.receive(in(20s)).error().code, Errc::connection_lost);
}

TEST_F(WebSocketLinkTest, DoesNotAllocateWhileItSendsAndReceives) {
    auto link = connected();
    const std::string text(700, 'x');
    ASSERT_TRUE(link.send(text, in(10s)));
    heard();  // so the server knows its client
    server_.send(text);
    ASSERT_TRUE(link.receive(in(10s)));
    const auto before = allocationCount();
    std::size_t of_the_test = 0;
    for (int i = 0; i < 20; ++i) {
        const auto here = allocationCount();
        server_.send(text);
        of_the_test += allocationCount() - here;
        ASSERT_TRUE(link.send(text, in(10s)));
        ASSERT_TRUE(link.receive(in(10s)));
    }
    EXPECT_EQ(allocationCount() - before - of_the_test, 0U);
}

TEST(WebSocketLinkConnect, TellsThatNobodyListens) {
    const auto link = WebSocketLink::connect("127.0.0.1", 1, in(10s));
    ASSERT_FALSE(link);
    EXPECT_EQ(link.error().code, Errc::connection_lost);
    EXPECT_THAT(link.error().message, HasSubstr("127.0.0.1:1:"));
}

TEST(WebSocketLinkConnect, GivesUpOnAServerThatNeverAnswers) {
    auto listener = std::move(link::TcpListener::listen("127.0.0.1", 0).value());
    const auto link = WebSocketLink::connect("127.0.0.1", listener.port(), in(50ms));
    ASSERT_FALSE(link);
    EXPECT_EQ(link.error().code, Errc::timeout);
}

TEST(WebSocketLinkConnect, RefusesAServerOfAnotherProtocol) {
    auto listener = std::move(link::TcpListener::listen("127.0.0.1", 0).value());
    std::jthread other([&] {
        auto peer = listener.accept(in(10s));
        ASSERT_TRUE(peer);
        const std::string answer = "SSH-2.0-OpenSSH_9.2\r\n\r\n";
        ASSERT_TRUE(peer->send(std::as_bytes(std::span(answer)), in(10s)));
    });
    const auto link = WebSocketLink::connect("127.0.0.1", listener.port(), in(10s));
    ASSERT_FALSE(link);
    EXPECT_EQ(link.error().code, Errc::connection_lost);
}

}  // namespace
}  // namespace metier::edo_driver
