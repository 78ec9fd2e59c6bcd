// The TCP ConnectionManager alone: an application of the test's own on one side, a plain socket
// on the other, both run by one thread.

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "event_loop.hpp"
#include "tcp_parameters.hpp"

namespace metier::opcua {

namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kMuch = 300'000;  // [byte], more than the sockets' buffers take

/// A plain, non-blocking socket connected to a port of this machine.
class Peer {
public:
    explicit Peer(std::uint16_t port, int receive_buffer = 0)
        : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
        if (receive_buffer > 0) {
            ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof(receive_buffer));
        }
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address));  // NOLINT
    }
    ~Peer() { hangUp(); }
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;

    void say(const std::string& text) const { ::send(socket_, text.data(), text.size(), 0); }
    /// Reads what is there, at most `most` bytes.
    std::string hear(std::size_t most = 65536) const {
        std::string text(most, '\0');
        const auto size = ::recv(socket_, text.data(), text.size(), MSG_DONTWAIT);
        text.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
        return text;
    }
    /// Hangs up once the system knows of it on the other side, too.
    void leave() {
        ::shutdown(socket_, SHUT_WR);
        const auto deadline = std::chrono::steady_clock::now() + 10s;
        tcp_info now{};
        do {
            socklen_t size = sizeof(now);
            ::getsockopt(socket_, IPPROTO_TCP, TCP_INFO, &now, &size);
        } while (now.tcpi_state == TCP_FIN_WAIT1 && std::chrono::steady_clock::now() < deadline);
        hangUp();
    }
    void hangUp() {
        if (socket_ >= 0) {
            ::close(std::exchange(socket_, -1));
        }
    }

private:
    int socket_;
};

/// Listens, and records the callbacks for every connection.
class LoopConnections : public ::testing::Test {
protected:
    struct Report {
        ConnectionId id = 0;
        UA_ConnectionState state{};
        std::string text;
    };

    void start(EventLoopOptions options = {}) {
        loop_.emplace(options);
        loop_->handle()->start(loop_->handle());
    }
    UA_ConnectionManager* manager() {
        return reinterpret_cast<UA_ConnectionManager*>(loop_->handle()->eventSources);  // NOLINT
    }
    UA_StatusCode open(std::uint16_t port, bool listen, std::string address = "127.0.0.1",
                       bool validate = false) {
        UA_String text{address.size(), reinterpret_cast<UA_Byte*>(address.data())};  // NOLINT
        std::array<UA_KeyValuePair, 4> pairs{};
        pairs[0].key = {0, UA_STRING_STATIC("port")};
        UA_Variant_setScalar(&pairs[0].value, &port, &UA_TYPES[UA_TYPES_UINT16]);
        pairs[1].key = {0, UA_STRING_STATIC("listen")};
        UA_Variant_setScalar(&pairs[1].value, &listen, &UA_TYPES[UA_TYPES_BOOLEAN]);
        pairs[2].key = {0, UA_STRING_STATIC("validate")};
        UA_Variant_setScalar(&pairs[2].value, &validate, &UA_TYPES[UA_TYPES_BOOLEAN]);
        pairs[3].key = {0, UA_STRING_STATIC("address")};
        UA_Variant_setScalar(&pairs[3].value, &text, &UA_TYPES[UA_TYPES_STRING]);
        const UA_KeyValueMap map{address.empty() ? 3U : 4U, pairs.data()};
        return manager()->openConnection(manager(), &map, this, nullptr, callback);
    }
    std::uint16_t listen() {
        EXPECT_EQ(open(0, true), UA_STATUSCODE_GOOD);
        return loop_->listening().front().port;
    }
    UA_StatusCode send(ConnectionId id, std::size_t size) {
        UA_ByteString buffer;
        manager()->allocNetworkBuffer(manager(), id, &buffer, size);
        std::fill_n(buffer.data, size, UA_Byte{'x'});
        return manager()->sendWithConnection(manager(), id, &UA_KEYVALUEMAP_NULL, &buffer);
    }
    bool runUntil(const std::function<bool()>& done) {
        const auto deadline = std::chrono::steady_clock::now() + 10s;
        bool is_done = done();
        while (!is_done && std::chrono::steady_clock::now() < deadline) {
            EXPECT_TRUE(loop_->runOnce(5ms));
            is_done = done();
        }
        return is_done;
    }
    /// Runs until so many connections were accepted or opened. \return the last one's id
    ConnectionId established(std::size_t count) {
        EXPECT_TRUE(runUntil([&] { return opened_.size() >= count; }));
        return opened_.empty() ? 0 : opened_.back();
    }

    static void callback(UA_ConnectionManager*, uintptr_t id, void* application, void** context,
                         UA_ConnectionState state, const UA_KeyValueMap* parameters,
                         UA_ByteString message) {
        auto& self = *static_cast<LoopConnections*>(application);
        if (UA_KeyValueMap_get(parameters, {0, UA_STRING_STATIC("listen-port")}) != nullptr) {
            self.listener_ = id;
            return;
        }
        if (state == UA_CONNECTIONSTATE_CLOSING) {
            if (id != self.listener_) {
                self.closed_.push_back(id);
            }
            return;
        }
        if (state == UA_CONNECTIONSTATE_ESTABLISHED && *context != application) {
            *context = application;
            self.opened_.push_back(id);
        }
        self.heard_.append(message.data, message.data + message.length);
        if (self.on_message_) {
            self.on_message_(id);
        }
    }

    ConnectionId listener_ = 0;
    std::vector<ConnectionId> opened_;
    std::vector<ConnectionId> closed_;
    std::string heard_;
    std::function<void(ConnectionId)> on_message_;
    std::optional<AsioEventLoop> loop_;  // last: its end notifies the members above
};

TEST_F(LoopConnections, CarryBytesBothWaysAndEndOnce) {
    start();
    Peer peer(listen());
    const auto id = established(1);
    peer.say("hello");
    ASSERT_TRUE(runUntil([&] { return heard_ == "hello"; }));
    send(id, 3);
    ASSERT_TRUE(runUntil([&] { return peer.hear() == "xxx"; }));
    peer.hangUp();
    ASSERT_TRUE(runUntil([&] { return !closed_.empty(); }));
    EXPECT_EQ(send(id, 3), UA_STATUSCODE_BADCONNECTIONCLOSED);
    EXPECT_EQ(manager()->closeConnection(manager(), id), UA_STATUSCODE_BADNOTFOUND);
    ASSERT_TRUE(loop_->runOnce(5ms));
    EXPECT_THAT(closed_, ElementsAre(id));
    EXPECT_EQ(loop_->statistics().connections, 0);
}

TEST_F(LoopConnections, TellTheEndLaterWhenClosedFromTheirOwnCallback) {
    start();
    Peer peer(listen());
    std::vector<std::size_t> closed_when_returning;
    on_message_ = [&](ConnectionId id) {
        manager()->closeConnection(manager(), id);
        manager()->closeConnection(manager(), id);
        closed_when_returning.push_back(closed_.size());
    };
    ASSERT_TRUE(runUntil([&] { return !closed_.empty(); }));
    EXPECT_THAT(closed_when_returning, ElementsAre(0));
    EXPECT_THAT(closed_, ElementsAre(opened_.front()));
}

// The data of one peer may cause events, which would be lost on a peer that has left.
TEST_F(LoopConnections, TellWhoHasLeftBeforeWhatOthersSay) {
    start();
    const auto port = listen();
    Peer talker(port);
    established(1);
    Peer leaver(port);
    const auto left = established(2);
    std::vector<ConnectionId> closed_when_heard;
    on_message_ = [&](ConnectionId) { closed_when_heard = closed_; };
    talker.say("hello");
    leaver.leave();
    ASSERT_TRUE(runUntil([&] { return heard_ == "hello"; }));
    EXPECT_THAT(closed_when_heard, ElementsAre(left));
}

TEST_F(LoopConnections, CutAPeerThatIsOwedTooMuch) {
    start({.send_queue_limit = 1U << 20U, .stall_limit = 1h, .kernel_send_buffer = 8192});
    const auto port = listen();
    Peer deaf(port, 4096);
    const auto id = established(1);
    UA_StatusCode sent = UA_STATUSCODE_GOOD;
    for (int i = 0; i < 1000 && sent == UA_STATUSCODE_GOOD; ++i) {
        sent = send(id, 65536);
    }
    EXPECT_EQ(sent, UA_STATUSCODE_BADCONNECTIONCLOSED);
    EXPECT_THAT(closed_, IsEmpty());
    ASSERT_TRUE(runUntil([&] { return !closed_.empty(); }));
    EXPECT_THAT(closed_, ElementsAre(id));
    EXPECT_EQ(loop_->statistics().cut_peers, 1);
    EXPECT_EQ(loop_->statistics().queued_bytes, 0);
}

TEST_F(LoopConnections, CutAPeerThatTakesNothingAndServeTheOthersMeanwhile) {
    start({.stall_limit = 1s, .kernel_send_buffer = 8192});
    const auto port = listen();
    Peer deaf(port, 4096);
    const auto deaf_id = established(1);
    Peer other(port);
    const auto other_id = established(2);
    const auto start = std::chrono::steady_clock::now();
    send(deaf_id, 1U << 20U);
    int served = 0;
    ASSERT_TRUE(runUntil([&] {
        send(other_id, 10);
        served += other.hear().empty() ? 0 : 1;
        return !closed_.empty();
    }));
    EXPECT_THAT(closed_, ElementsAre(deaf_id));
    EXPECT_GE(std::chrono::steady_clock::now() - start, 1s);
    EXPECT_GT(served, 5);
}

TEST_F(LoopConnections, KeepASlowReaderThatGoesOnReading) {
    // The pauses are far below the limit, also on a machine that holds this thread up.
    constexpr auto kPause = 16ms;
    constexpr std::size_t kAtOnce = 2048;  // [byte]
    constexpr auto kLimit = 1s;
    static_assert(kMuch / kAtOnce * kPause > 2 * kLimit);
    start({.stall_limit = kLimit, .kernel_send_buffer = 8192});
    Peer slow(listen(), 4096);
    const auto id = established(1);
    send(id, kMuch);
    auto next = std::chrono::steady_clock::now();
    std::size_t read = 0;
    ASSERT_TRUE(runUntil([&] {
        if (const auto now = std::chrono::steady_clock::now(); now >= next) {
            read += slow.hear(kAtOnce).size();
            next = now + kPause;
        }
        return read == kMuch || !closed_.empty();
    }));
    EXPECT_EQ(read, kMuch);
    EXPECT_THAT(closed_, IsEmpty());
}

TEST_F(LoopConnections, BeyondTheLimitAreClosedAtOnce) {
    start({.max_connections = 1});
    const auto port = listen();
    Peer first(port);
    established(1);
    Peer second(port);
    ASSERT_TRUE(runUntil([&] { return loop_->statistics().refused == 1; }));
    EXPECT_EQ(loop_->statistics().connections, 1);
    first.hangUp();
    ASSERT_TRUE(runUntil([&] { return !closed_.empty(); }));
    Peer third(port);
    established(2);
}

TEST_F(LoopConnections, OpenToAServerAndTellWhenTheyAre) {
    start();
    const auto port = listen();
    ASSERT_EQ(open(port, false), UA_STATUSCODE_GOOD);
    established(2);  // both ends
    EXPECT_EQ(loop_->statistics().connections, 2);
}

TEST_F(LoopConnections, OpenByNameOnIpv4OrIpv6) {
    start();
    ASSERT_EQ(open(0, true, "::1"), UA_STATUSCODE_GOOD);
    ASSERT_EQ(open(loop_->listening().front().port, false, "::1"), UA_STATUSCODE_GOOD);
    established(2);
    ASSERT_EQ(open(0, true, "localhost"), UA_STATUSCODE_GOOD);
    for (const auto& address : loop_->listening()) {
        if (address.address == "localhost") {
            ASSERT_EQ(open(address.port, false, "localhost"), UA_STATUSCODE_GOOD);
        }
    }
    established(4);
}

TEST_F(LoopConnections, ToAClosedPortEndWithoutHavingBeenOpen) {
    start();
    const auto port = listen();
    manager()->closeConnection(manager(), listener_);
    ASSERT_TRUE(runUntil([&] { return loop_->listening().empty(); }));
    ASSERT_EQ(open(port, false), UA_STATUSCODE_GOOD);
    ASSERT_TRUE(runUntil([&] { return !closed_.empty(); }));
    EXPECT_THAT(opened_, IsEmpty());
    EXPECT_THAT(loop_->lastNetworkError(), HasSubstr("Connection refused"));
    EXPECT_THAT(loop_->lastNetworkError(), HasSubstr(std::to_string(port)));
}

TEST_F(LoopConnections, ThatDoNotOpenInTimeEnd) {
    start({.connect_limit = 50ms});
    const auto port = listen();
    // Nobody accepts: the loop is not run for this listener, its backlog is filled by a full one.
    const int full = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    ::bind(full, reinterpret_cast<sockaddr*>(&address), size);  // NOLINT
    ::listen(full, 0);
    ::getsockname(full, reinterpret_cast<sockaddr*>(&address), &size);  // NOLINT
    for (int i = 0; i < 4; ++i) {  // more than the backlog takes: the rest gets no answer
        ASSERT_EQ(open(ntohs(address.sin_port), false), UA_STATUSCODE_GOOD);
    }
    ASSERT_TRUE(runUntil([&] { return !closed_.empty(); }));
    EXPECT_THAT(loop_->lastNetworkError(), HasSubstr("no answer within 50 ms"));
    ::close(full);
    EXPECT_NE(port, 0);
}

TEST_F(LoopConnections, NeverShareAPortWithAnotherListener) {
    start();
    const auto port = listen();
    EXPECT_EQ(open(port, true), UA_STATUSCODE_BADCONNECTIONREJECTED);
    EXPECT_THAT(loop_->lastNetworkError(), HasSubstr("Address already in use"));
    EXPECT_EQ(open(port, true, ""), UA_STATUSCODE_BADCONNECTIONREJECTED);  // not on IPv6 alone
    EXPECT_EQ(loop_->listening().size(), 1);
}

TEST_F(LoopConnections, OnAllInterfacesListenOnOnePort) {
    start();
    ASSERT_EQ(open(0, true, ""), UA_STATUSCODE_GOOD);
    const auto listening = loop_->listening();
    for (const auto& address : listening) {
        EXPECT_EQ(address.port, listening.front().port);
        EXPECT_EQ(address.address, "");
    }
}

TEST_F(LoopConnections, AreOnlyCheckedWhenValidated) {
    start();
    EXPECT_EQ(open(0, true, "127.0.0.1", true), UA_STATUSCODE_GOOD);
    EXPECT_EQ(open(1, false, "127.0.0.1", true), UA_STATUSCODE_GOOD);
    EXPECT_EQ(open(1, false, "", true), UA_STATUSCODE_BADCONNECTIONREJECTED);
    EXPECT_THAT(loop_->listening(), IsEmpty());
    EXPECT_EQ(loop_->statistics().connections, 0);
}

TEST_F(LoopConnections, AllEndBeforeAStoppedLoopHasStopped) {
    start({.kernel_send_buffer = 8192});
    const auto port = listen();
    Peer deaf(port, 4096);
    send(established(1), 1U << 20U);
    auto* handle = loop_->handle();
    handle->stop(handle);
    EXPECT_EQ(handle->state, UA_EVENTLOOPSTATE_STOPPING);
    ASSERT_TRUE(runUntil([&] { return handle->state == UA_EVENTLOOPSTATE_STOPPED; }));
    EXPECT_EQ(closed_.size(), 1);
    EXPECT_EQ(handle->free(handle), UA_STATUSCODE_GOOD);
}

TEST_F(LoopConnections, AllEndWhenTheLoopIsDestroyed) {
    start();
    Peer peer(listen());
    established(1);
    loop_.reset();
    EXPECT_EQ(closed_.size(), 1);
}

}  // namespace

}  // namespace metier::opcua
