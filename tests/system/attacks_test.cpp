// Attacks in short, as root: what Halt takes meanwhile, and who is cut. In bulk: metier_attacks.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "attacks/churn.hpp"
#include "attacks/requests.hpp"
#include "attacks/siege.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;

class UnderAttack : public ::testing::TestWithParam<Attack> {};

// 50 ms (99 %), 200 ms at most, besides what the machine's other work makes of it.
TEST_P(UnderAttack, HaltGetsThrough) {
    if (const auto obstacle = Cable::obstacle(); !obstacle.empty()) {
        GTEST_SKIP() << "NOT TESTED: Halt under attack over a network: " << obstacle;
    }
    Cable cable;
    Siege siege(cable);
    const auto outcome = siege.run(GetParam(), 4s);
    EXPECT_EQ(outcome.defect, "");
    EXPECT_GT(outcome.during.answered.count, 10U);
    EXPECT_GT(outcome.attack.connections, 0U);
}

INSTANTIATE_TEST_SUITE_P(Attacks, UnderAttack, ::testing::ValuesIn(kAttacks),
                         [](const auto& of) { return std::string(toString(of.param)); });

// An operator has a Session within 2 s, from another address than the strangers' and from theirs.
TEST(Churn, OfStrangersKeepsNoOperatorOut) {
    if (const auto obstacle = Cable::obstacle(); !obstacle.empty()) {
        GTEST_SKIP() << "NOT TESTED: strangers that come and go over a network: " << obstacle;
    }
    Cable cable;
    Churn churn(cable, std::filesystem::path(::testing::TempDir()) / "churn");
    const auto outcome = churn.run(20s);
    EXPECT_EQ(outcome.defect, "");
    EXPECT_GT(outcome.attack.connections, 1000U);
}

/// Reads what a server sends over a slow cable until there is nothing more, or it is cut.
std::size_t readAll(RawPeer& peer, std::size_t expected) {
    std::size_t total = 0;
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (total < expected && std::chrono::steady_clock::now() < end) {
        const auto some = peer.drainSome();
        if (!some) {
            break;
        }
        total += *some;
    }
    return total;
}

// At 1 Mbit/s, with data waiting for 200 ms: more than the 2 s go by in which a peer must make
// progress, and it makes progress.
TEST(SlowReader, IsNotCut) {
    if (const auto obstacle = Cable::obstacle(); !obstacle.empty()) {
        GTEST_SKIP() << "NOT TESTED: a slow reader on a network: " << obstacle;
    }
    Cable cable;
    BenchServer server;
    server.serve();
    cable.slowDown(1'000'000, 200ms);
    std::size_t read = 0;
    constexpr std::size_t kMuch = 600'000;  // [byte], 5 s
    std::jthread([&] {
        cable.enterFarEnd();
        RawPeer peer(Cable::kNearAddress, server.port(), 64 * 1024, 10s);
        ASSERT_TRUE(peer.logIn());
        for (int i = 0; i < 60; ++i) {  // some 10 kB each
            peer.request(request::kBrowse, browseOf(10));
        }
        read = readAll(peer, kMuch);
    }).join();
    EXPECT_GE(read, kMuch);
}

}  // namespace
}  // namespace metier::system_tests
