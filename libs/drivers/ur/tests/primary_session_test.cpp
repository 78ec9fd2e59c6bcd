#include "primary_session.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <future>

#include "wire_bytes.hpp"

namespace metier::ur_driver {
namespace {

using namespace std::chrono_literals;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

std::vector<std::byte> version(int major) {
    return primaryPackage(20, WireBytes()
                                  .u64(1)
                                  .u8(0xfe)
                                  .u8(3)
                                  .u8(1)
                                  .text("U")
                                  .u8(static_cast<unsigned>(major))
                                  .u8(1)
                                  .i32(0)
                                  .i32(0)
                                  .bytes());
}

class PrimarySessionTest : public testing::Test {
protected:
    link::TcpLink accept() { return listener_.accept(in(accept_within_)).value(); }
    Result<PrimarySession> connect() {
        return PrimarySession::connect("127.0.0.1", listener_.port(), in(5000ms));
    }

    std::chrono::milliseconds accept_within_ = 5s;
    link::TcpListener listener_ = link::TcpListener::listen("127.0.0.1", 0).value();
};

TEST_F(PrimarySessionTest, TakesPackagesThatComeInPieces) {
    auto session = connect().value();
    auto peer = accept();
    const auto bytes = WireBytes().append(version(3)).append(version(5)).bytes();
    ASSERT_TRUE(peer.send(std::span(bytes).first(7), in(1000ms)));
    EXPECT_EQ(session.next(in(10ms)).error().code, Errc::timeout);
    ASSERT_TRUE(peer.send(std::span(bytes).subspan(7), in(1000ms)));
    EXPECT_EQ(session.next(in(5000ms))->version->major, 3);
    EXPECT_EQ(session.next(in(5000ms))->version->major, 5);
}

TEST_F(PrimarySessionTest, TellsGarbageAndTheEndWithThePeersName) {
    auto session = connect().value();
    auto peer = accept();
    ASSERT_TRUE(peer.send(fromHex("00 00 00 01 10"), in(1000ms)));
    const auto garbage = session.next(in(5000ms));
    ASSERT_FALSE(garbage);
    EXPECT_EQ(garbage.error().code, Errc::invalid_argument);
    EXPECT_THAT(garbage.error().message, testing::StartsWith("127.0.0.1:"));

    auto third = connect().value();
    auto third_peer = accept();
    ASSERT_TRUE(third_peer.send(fromHex("00 00 00 06 10 05"), in(1000ms)));
    EXPECT_THAT(third.next(in(5000ms)).error().message, testing::StartsWith("127.0.0.1:"));

    auto second = connect().value();
    accept().shutdown();
    EXPECT_EQ(second.next(in(5000ms)).error().code, Errc::connection_lost);
}

TEST_F(PrimarySessionTest, ADescriptionMayBeIncomplete) {
    auto told = std::async(std::launch::async, [this] {
        return readDescription("127.0.0.1", listener_.port(), in(2000ms));
    });
    auto peer = accept();
    ASSERT_TRUE(peer.send(version(3), in(1000ms)));
    const auto description = told.get();
    ASSERT_TRUE(description);
    EXPECT_TRUE(description->version);
    EXPECT_FALSE(description->complete());
}

TEST_F(PrimarySessionTest, ADescriptionMayEndWithTheLink) {
    auto told = std::async(std::launch::async, [this] {
        return readDescription("127.0.0.1", listener_.port(), in(5000ms));
    });
    {
        auto peer = accept();
        ASSERT_TRUE(peer.send(version(3), in(1000ms)));
    }
    const auto description = told.get();
    ASSERT_TRUE(description);
    EXPECT_EQ(description->version->major, 3);
}

TEST_F(PrimarySessionTest, NoDescriptionIsAnError) {
    auto told = std::async(std::launch::async, [this] {
        return readDescription("127.0.0.1", listener_.port(), in(300ms));
    });
    auto peer = accept();
    EXPECT_EQ(told.get().error().code, Errc::timeout);
}

TEST_F(PrimarySessionTest, TheMonitorConnectsAgainAfterTheEndSilenceAndGarbage) {
    accept_within_ = 20s;
    std::atomic<int> last{0};
    std::promise<void> five;
    const PrimaryMonitor monitor(
        "127.0.0.1", listener_.port(), [&](const primary::Package& package) {
            if (package.version &&
                last.exchange(package.version->major) != package.version->major &&
                package.version->major == 5) {
                five.set_value();
            }
        });
    accept().shutdown();
    auto silent = accept();
    auto garbler = accept();  // silence ends a connection after 2 s
    ASSERT_TRUE(garbler.send(fromHex("FF FF FF FF FF FF"), in(1000ms)));
    auto peer = accept();
    ASSERT_TRUE(peer.send(version(5), in(1000ms)));
    EXPECT_EQ(five.get_future().wait_for(5s), std::future_status::ready);
}

}  // namespace
}  // namespace metier::ur_driver
