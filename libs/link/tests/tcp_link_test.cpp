#include "metier/link/tcp_link.hpp"

#include <gmock/gmock.h>

#include <array>
#include <future>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "metier/base/testing/allocation_count.hpp"

namespace metier::link {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

std::span<const std::byte> bytesOf(std::string_view text) {
    return std::as_bytes(std::span(text));
}

struct Pair {
    TcpListener listener = TcpListener::listen("127.0.0.1", 0).value();
    TcpLink near = TcpLink::connect("127.0.0.1", listener.port(), in(30s)).value();
    TcpLink far = listener.accept(in(30s)).value();
};

TEST(TcpLink, CarriesBytesBothWays) {
    Pair pair;
    ASSERT_TRUE(pair.near.send(bytesOf("ping"), in(30s)));
    std::array<std::byte, 4> buffer{};
    ASSERT_TRUE(pair.far.receiveAll(buffer, in(30s)));
    EXPECT_EQ(std::string_view(reinterpret_cast<const char*>(buffer.data()), 4), "ping");
    ASSERT_TRUE(pair.far.send(bytesOf("pong"), in(30s)));
    EXPECT_EQ(pair.near.receive(buffer, in(30s)), 4U);
}

TEST(TcpLink, TellsWhoDidNotAnswerInTime) {
    Pair pair;
    std::array<std::byte, 4> buffer{};
    const auto silent = pair.near.receive(buffer, in(20ms));
    ASSERT_FALSE(silent);
    EXPECT_EQ(silent.error().code, Errc::timeout);
    EXPECT_THAT(silent.error().message, HasSubstr("127.0.0.1:"));
}

TEST(TcpLink, TellsThatThePeerIsGone) {
    Pair pair;
    pair.far.shutdown();
    std::array<std::byte, 4> buffer{};
    const auto closed = pair.near.receive(buffer, in(30s));
    ASSERT_FALSE(closed);
    EXPECT_EQ(closed.error().code, Errc::connection_lost);
    EXPECT_THAT(closed.error().message, HasSubstr("closed"));
}

TEST(TcpLink, TellsThatThePeerIsGoneThoughItHasNotReadAll) {
    Pair pair;
    ASSERT_TRUE(pair.near.send(bytesOf("ping"), in(30s)));
    { const auto gone = std::move(pair.far); }  // which resets the connection
    std::array<std::byte, 4> buffer{};
    for (const auto& lost : {pair.near.receive(buffer, in(30s)).map([](std::size_t) {}),
                             pair.near.send(bytesOf("ping"), in(30s))}) {
        ASSERT_FALSE(lost);
        EXPECT_EQ(lost.error().code, Errc::connection_lost);
        EXPECT_THAT(lost.error().message, HasSubstr("closed the connection"));
    }
}

TEST(TcpLink, IsWokenByShutdownFromAnotherThread) {
    Pair pair;
    auto reading = std::async(std::launch::async, [&] {
        std::array<std::byte, 4> buffer{};
        return pair.near.receive(buffer, in(30s));
    });
    pair.near.shutdown();
    const auto outcome = reading.get();
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().code, Errc::connection_lost);
}

TEST(TcpLink, GivesUpOnAPeerThatDoesNotRead) {
    Pair pair;
    const std::vector<std::byte> much(32'000'000);
    const auto sent = pair.near.send(much, in(50ms));
    ASSERT_FALSE(sent);
    EXPECT_EQ(sent.error().code, Errc::timeout);
}

TEST(TcpLink, DoesNotAllocateWithoutAnError) {
    Pair pair;
    std::array<std::byte, 64> buffer{};
    const auto before = allocationCount();
    for (int i = 0; i < 100; ++i) {
        ASSERT_TRUE(pair.near.send(buffer, in(30s)));
        ASSERT_TRUE(pair.far.receiveAll(buffer, in(30s)));
    }
    EXPECT_EQ(allocationCount(), before);
}

TEST(TcpLink, TakesThePlaceOfAnother) {
    Pair first;
    Pair second;
    first.near = std::move(second.near);
    first.listener = std::move(second.listener);
    std::array<std::byte, 4> buffer{};
    EXPECT_EQ(first.far.receive(buffer, in(30s)).error().code, Errc::connection_lost);
    ASSERT_TRUE(second.far.send(bytesOf("here"), in(30s)));
    EXPECT_TRUE(first.near.receiveAll(buffer, in(30s)));
}

TEST(TcpLink, CannotConnectWhereNobodyListens) {
    const auto port = TcpListener::listen("127.0.0.1", 0).value().port();
    const auto link = TcpLink::connect("127.0.0.1", port, in(30s));
    ASSERT_FALSE(link);
    EXPECT_EQ(link.error().code, Errc::connection_lost);
    EXPECT_THAT(link.error().message, HasSubstr(std::to_string(port)));
}

TEST(TcpListener, RefusesAPortThatIsTaken) {
    const auto first = TcpListener::listen("127.0.0.1", 0).value();
    const auto second = TcpListener::listen("127.0.0.1", first.port());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::already_exists);
}

TEST(TcpListener, EndsItsWaitAtTheDeadlineAndAtShutdown) {
    auto listener = TcpListener::listen("127.0.0.1", 0).value();
    EXPECT_EQ(listener.accept(in(10ms)).error().code, Errc::timeout);
    auto accepting = std::async(std::launch::async, [&] { return listener.accept(in(30s)); });
    listener.shutdown();
    EXPECT_EQ(accepting.get().error().code, Errc::cancelled);
}

TEST(TcpListener, RefusesWhatIsNoAddress) {
    const auto listener = TcpListener::listen("robot", 0);
    ASSERT_FALSE(listener);
    EXPECT_EQ(listener.error().code, Errc::invalid_argument);
}

}  // namespace
}  // namespace metier::link
