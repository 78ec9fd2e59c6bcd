#include "metier/virtual_controller/peer_lines.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace metier::virtual_controller {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A peer that only notes whether it was reset.
class NotedPeer final : public TcpPeer {
public:
    using TcpPeer::send;
    void send(std::span<const std::byte>) override {}
    void close() override {}
    void reset() override { was_reset = true; }
    std::size_t queued() const override { return 0; }
    const std::string& address() const override { return address_; }

    bool was_reset = false;

private:
    std::string address_ = "127.0.0.1:1";
};

struct LinesOfTenBytes : ::testing::Test {
    void add(TcpPeer& from, std::string_view text) {
        lines.add(from, std::as_bytes(std::span(text)),
                  [&](std::string_view line) { taken.emplace_back(line); });
    }

    PeerLines lines{10};
    NotedPeer peer;
    std::vector<std::string> taken;
};

TEST_F(LinesOfTenBytes, AreCutWhereverTheReadsEnd) {
    for (const auto* part : {"on", "e\ntwo\n", "", "\nth", "ree", "\n"}) {
        add(peer, part);
    }
    EXPECT_THAT(taken, ElementsAre("one", "two", "", "three"));
    EXPECT_FALSE(peer.was_reset);
}

TEST_F(LinesOfTenBytes, AreKeptApartByPeer) {
    NotedPeer other;
    add(peer, "of one");
    add(other, "of another\n");
    add(peer, "\n");
    EXPECT_THAT(taken, ElementsAre("of another", "of one"));
}

TEST_F(LinesOfTenBytes, AreNotContinuedByThePeerThatComesNext) {
    add(peer, "half");
    lines.forget(peer);
    add(peer, "whole\n");
    EXPECT_THAT(taken, ElementsAre("whole"));
}

TEST_F(LinesOfTenBytes, MayHaveTenBytes) {
    add(peer, "0123456789");
    EXPECT_FALSE(peer.was_reset);
    add(peer, "\n");
    EXPECT_THAT(taken, ElementsAre("0123456789"));
    EXPECT_FALSE(peer.was_reset);
}

TEST_F(LinesOfTenBytes, ResetAPeerWhoseLineDoesNotEnd) {
    add(peer, "0123456789a");
    EXPECT_TRUE(peer.was_reset);
    EXPECT_THAT(taken, IsEmpty());
}

TEST_F(LinesOfTenBytes, ResetAPeerWhoseLongLineComesInOneRead) {
    add(peer, "short\n0123456789a\nafter\n");
    EXPECT_TRUE(peer.was_reset);
    EXPECT_THAT(taken, ElementsAre("short"));
}

}  // namespace
}  // namespace metier::virtual_controller
