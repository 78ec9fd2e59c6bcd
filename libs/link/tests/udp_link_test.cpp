#include "metier/link/udp_link.hpp"

#include <gmock/gmock.h>

#include <array>
#include <asio/buffer.hpp>
#include <asio/ip/udp.hpp>
#include <string_view>
#include <vector>

#include "metier/base/testing/allocation_count.hpp"

namespace metier::link {
namespace {

using namespace std::chrono_literals;
using asio::ip::udp;
using ::testing::HasSubstr;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

std::span<const std::byte> bytesOf(std::string_view text) {
    return std::as_bytes(std::span(text));
}

/// A peer on loopback, which waits without an end: the tests' own time-out is its deadline.
struct Peer {
    std::string hear() {
        std::array<char, 64> buffer{};
        return {buffer.data(), socket.receive_from(asio::buffer(buffer), from)};
    }
    void say(std::string_view text) {
        socket.send_to(asio::buffer(text.data(), text.size()), from);
    }
    std::uint16_t port() const { return socket.local_endpoint().port(); }

    asio::io_context context;
    udp::socket socket{context, udp::endpoint(asio::ip::make_address("127.0.0.1"), 0)};
    udp::endpoint from;
};

TEST(UdpLink, CarriesDatagramsBothWays) {
    Peer peer;
    auto link = UdpLink::connect("127.0.0.1", peer.port(), in(30s)).value();
    ASSERT_TRUE(link.send(bytesOf("ping")));
    EXPECT_EQ(peer.hear(), "ping");
    peer.say("pong");
    peer.say("again");
    std::array<std::byte, 16> buffer{};
    EXPECT_EQ(link.receive(buffer, in(30s)), 4U) << "one datagram at a time";
    EXPECT_EQ(link.receive(buffer, in(30s)), 5U);
}

TEST(UdpLink, CutsADatagramThatIsTooLong) {
    Peer peer;
    auto link = UdpLink::connect("127.0.0.1", peer.port(), in(30s)).value();
    ASSERT_TRUE(link.send(bytesOf("ping")));
    peer.hear();
    peer.say("much too long");
    std::array<std::byte, 4> buffer{};
    EXPECT_EQ(link.receive(buffer, in(30s)), 4U);
}

TEST(UdpLink, TellsWhoDidNotAnswerInTime) {
    Peer peer;
    auto link = UdpLink::connect("127.0.0.1", peer.port(), in(30s)).value();
    std::array<std::byte, 4> buffer{};
    const auto silent = link.receive(buffer, in(20ms));
    ASSERT_FALSE(silent);
    EXPECT_EQ(silent.error().code, Errc::timeout);
    EXPECT_THAT(silent.error().message, HasSubstr(link.peer()));
}

TEST(UdpLink, HearsNobodyElse) {
    Peer peer;
    Peer other;
    auto link = UdpLink::connect("127.0.0.1", peer.port(), in(30s)).value();
    ASSERT_TRUE(link.send(bytesOf("ping")));
    peer.hear();
    other.from = peer.from;
    other.say("wrong");
    peer.say("right one");
    std::array<std::byte, 16> buffer{};
    EXPECT_EQ(link.receive(buffer, in(30s)), 9U);
}

TEST(UdpLink, TellsThatNobodyListens) {
    std::uint16_t port = 0;
    { port = Peer().port(); }
    auto link = UdpLink::connect("127.0.0.1", port, in(30s)).value();
    ASSERT_TRUE(link.send(bytesOf("ping")));
    std::array<std::byte, 4> buffer{};
    const auto refused = link.receive(buffer, in(30s));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::connection_lost);
}

TEST(UdpLink, RefusesAHostThatIsNone) {
    const auto link = UdpLink::connect("300.0.0.1", 1, in(30s));
    ASSERT_FALSE(link);
    EXPECT_EQ(link.error().code, Errc::connection_lost);
    EXPECT_THAT(link.error().message, HasSubstr("300.0.0.1:1"));
}

TEST(UdpLink, DoesNotAllocateWithoutAnError) {
    Peer peer;
    auto link = UdpLink::connect("127.0.0.1", peer.port(), in(30s)).value();
    ASSERT_TRUE(link.send(bytesOf("ping")));
    peer.hear();
    for (int i = 0; i < 100; ++i) {
        peer.say("0123456789");
    }
    std::array<std::byte, 64> buffer{};
    const auto before = allocationCount();
    for (int i = 0; i < 100; ++i) {
        ASSERT_TRUE(link.receive(buffer, in(30s)));
        ASSERT_TRUE(link.send(buffer));
    }
    EXPECT_EQ(allocationCount(), before);
}

}  // namespace
}  // namespace metier::link
