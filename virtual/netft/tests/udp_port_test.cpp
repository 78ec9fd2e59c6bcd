#include "udp_port.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <asio/post.hpp>
#include <chrono>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

namespace metier::virtual_netft {
namespace {

using namespace std::chrono_literals;
using asio::ip::udp;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A port and a peer of it; nothing happens but what the test runs.
class UdpPortOnTable : public ::testing::Test {
protected:
    UdpPortOnTable() { peer_.non_blocking(true); }

    static udp::endpoint local(std::uint16_t port) {
        return {asio::ip::make_address("127.0.0.1"), port};
    }
    std::unique_ptr<UdpPort> bind(UdpPort::OnDatagram on_datagram) {
        return UdpPort::bind(context_, local(0), faults_, std::move(on_datagram)).value();
    }
    /// Sends texts to the peer.
    void send(std::initializer_list<std::string_view> texts) {
        for (const auto text : texts) {
            const auto bytes = std::as_bytes(std::span(text));
            port_->send(peer_.local_endpoint(), {bytes.begin(), bytes.end()});
        }
    }
    /// Datagrams that the peer got.
    std::vector<std::string> got() {
        std::vector<std::string> all;
        std::array<char, 64> buffer{};
        asio::error_code none;
        while (const auto size = peer_.receive(asio::buffer(buffer), 0, none)) {
            all.emplace_back(buffer.data(), size);
        }
        return all;
    }
    /// Runs until the peer got so many.
    std::vector<std::string> await(std::size_t count) {
        const auto end = std::chrono::steady_clock::now() + 10s;
        auto all = got();
        while (all.size() < count && std::chrono::steady_clock::now() < end) {
            context_.run_one_for(10ms);
            std::ranges::move(got(), std::back_inserter(all));
        }
        return all;
    }
    /// Runs the handler of the next datagram that comes.
    void takeOne() { EXPECT_EQ(context_.run_one_for(10s), 1U); }
    void peerSends(std::string_view text) {
        peer_.send_to(asio::buffer(text.data(), text.size()), local(port_->port()));
    }

    asio::io_context context_;
    virtual_controller::LinkFaults faults_;
    std::vector<std::string> taken_;
    std::unique_ptr<UdpPort> port_ = bind([this](const auto&, std::span<const std::byte> bytes) {
        taken_.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    });
    udp::socket peer_{context_, local(0)};
};

TEST_F(UdpPortOnTable, KeepsTheOrderWhenTheDelayEnds) {
    faults_.delay_ms = 30;
    send({"one", "two"});
    faults_.delay_ms = 0;
    send({"three"});
    EXPECT_THAT(got(), IsEmpty());
    EXPECT_THAT(await(3), ElementsAre("one", "two", "three"));
}

TEST_F(UdpPortOnTable, LosesWhatWaitsWhenTheCableIsCut) {
    faults_.delay_ms = 10;
    send({"one"});
    faults_.cut = true;
    send({"two"});
    context_.run_for(30ms);
    context_.poll();
    faults_.cut = false;
    faults_.delay_ms = 0;
    send({"three"});
    EXPECT_THAT(got(), ElementsAre("three"));
}

TEST_F(UdpPortOnTable, LosesWhatComesOverACutCable) {
    faults_.cut = true;
    peerSends("lost");
    takeOne();
    faults_.cut = false;
    peerSends("found");
    takeOne();
    EXPECT_THAT(taken_, ElementsAre("found"));
}

TEST_F(UdpPortOnTable, LosesDatagramsBeyondTenThousandThatWait) {
    faults_.delay_ms = 20;
    const auto nobody = local(9);
    for (int i = 0; i < 9'999; ++i) {
        port_->send(nobody, {std::byte{}});
    }
    send({"the last that may wait", "one too many"});
    EXPECT_THAT(await(1), ElementsAre("the last that may wait"));
    EXPECT_THAT(got(), IsEmpty());
}

TEST_F(UdpPortOnTable, ServesItsPeerAlthoughAnotherOneIsNotThere) {
    udp::endpoint gone;
    {
        const udp::socket socket(context_, local(0));
        gone = socket.local_endpoint();
    }
    port_->send(gone, {std::byte{1}});
    context_.poll();
    port_->send(gone, {std::byte{1}});
    peerSends("hello");
    send({"hello, too"});
    EXPECT_THAT(await(1), ElementsAre("hello, too"));
    const auto end = std::chrono::steady_clock::now() + 10s;
    while (taken_.empty() && std::chrono::steady_clock::now() < end) {
        context_.run_one_for(10ms);
    }
    EXPECT_THAT(taken_, ElementsAre("hello"));
}

TEST_F(UdpPortOnTable, TakesNothingOnceItIsGone) {
    int taken = 0;
    port_ = bind([&](const auto&, auto) {
        ++taken;
        asio::post(context_, [this] { port_.reset(); });
    });
    peerSends("one");
    peerSends("two");
    context_.run_for(5s);
    EXPECT_FALSE(port_);
    EXPECT_EQ(taken, 1);
}

TEST_F(UdpPortOnTable, RefusesAPortThatIsTaken) {
    const auto second = UdpPort::bind(context_, local(port_->port()), faults_, {});
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::already_exists);
}

}  // namespace
}  // namespace metier::virtual_netft
