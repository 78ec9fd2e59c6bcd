// Connections that keep their place at a server, and strangers that lose it to others.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "event_loop_testing.hpp"

namespace metier::opcua::testing {
namespace {

/// A plain socket from an address of this machine, which says nothing.
class Stranger {
public:
    Stranger(std::uint16_t port, const char* from) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
        const timeval patience{10, 0};
        ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
        sockaddr_in address{};
        address.sin_family = AF_INET;
        ::inet_pton(AF_INET, from, &address.sin_addr);
        ::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address));  // NOLINT
        ::inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
        address.sin_port = htons(port);
        ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address));  // NOLINT
    }
    ~Stranger() {
        if (socket_ >= 0) {
            ::close(socket_);
        }
    }
    Stranger(Stranger&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
    Stranger& operator=(Stranger&&) = delete;
    Stranger(const Stranger&) = delete;
    Stranger& operator=(const Stranger&) = delete;

    /// Waits for the end of the connection. \return what came before it
    std::string lastWords() const {
        std::string words(100, '\0');
        const auto size = ::recv(socket_, words.data(), words.size(), 0);
        words.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
        return words;
    }
    bool isCut() const {
        char byte = 0;
        const auto size = ::recv(socket_, &byte, 1, MSG_DONTWAIT);
        return size == 0 || (size < 0 && errno != EAGAIN);
    }

private:
    int socket_;
};

class Strangers : public ::testing::Test {
protected:
    static constexpr std::size_t kPlaces = 10;

    void crowd(const char* from, std::size_t count) {
        const auto before = server_.statistics().accepted;
        for (std::size_t i = 0; i < count; ++i) {
            strangers_.emplace_back(server_.port(), from);
        }
        EXPECT_TRUE(eventually([&] {
            const auto now = server_.statistics();
            return now.accepted + now.refused >= before + count;
        }));
    }
    static bool eventually(const std::function<bool()>& holds) {
        const auto deadline = std::chrono::steady_clock::now() + kDeadline;
        bool held = holds();
        while (!held && std::chrono::steady_clock::now() < deadline) {
            held = holds();
        }
        return held;
    }
    std::size_t cut() const {
        return static_cast<std::size_t>(
            std::count_if(strangers_.begin(), strangers_.end(),
                          [](const Stranger& stranger) { return stranger.isCut(); }));
    }

    TestServer server_{{.loop = {.max_connections = kPlaces, .stranger_limit = 1h}}};
    std::vector<Stranger> strangers_;
};

TEST_F(Strangers, MakeRoomForTheNext) {
    crowd("127.0.0.1", kPlaces);
    EXPECT_EQ(cut(), 0U);
    TestClient client;
    EXPECT_EQ(client.connect(server_.url()), UA_STATUSCODE_GOOD);
    EXPECT_TRUE(eventually([&] { return cut() == 1; }));
    EXPECT_EQ(server_.statistics().dropped_strangers, 1U);
    EXPECT_EQ(server_.statistics().refused, 0U);
}

TEST_F(Strangers, OfTheAddressThatHasMostLoseTheirPlaces) {
    crowd("127.0.0.2", 2);
    crowd("127.0.0.1", 50);
    EXPECT_TRUE(eventually([&] { return cut() == 42; }));
    EXPECT_FALSE(strangers_[0].isCut());
    EXPECT_FALSE(strangers_[1].isCut());
}

TEST_F(Strangers, DoNotTakeThePlaceOfAMember) {
    TestClient member;
    ASSERT_EQ(member.connect(server_.url()), UA_STATUSCODE_GOOD);
    ASSERT_EQ(member.echo("me"), "me");
    server_.inServer([this](UA_Server*) { server_.loop().admit(server_.lastCaller()); });
    crowd("127.0.0.1", 50);
    EXPECT_EQ(member.echo("still here"), "still here");
}

TEST_F(Strangers, AreRefusedWithTooBusyWhenAllPlacesAreMembers) {
    std::vector<std::unique_ptr<TestClient>> members;
    for (std::size_t i = 0; i < kPlaces; ++i) {
        members.push_back(std::make_unique<TestClient>());
        ASSERT_EQ(members.back()->connect(server_.url()), UA_STATUSCODE_GOOD);
        ASSERT_EQ(members.back()->echo("me"), "me");
        server_.inServer([this](UA_Server*) { server_.loop().admit(server_.lastCaller()); });
    }
    const Stranger late(server_.port(), "127.0.0.1");
    const std::string bad_tcp_server_too_busy("ERRF\x10\0\0\0\0\0\x7D\x80\xFF\xFF\xFF\xFF", 16);
    EXPECT_EQ(late.lastWords(), bad_tcp_server_too_busy);
    EXPECT_EQ(server_.statistics().refused, 1U);
    EXPECT_EQ(members.front()->echo("still here"), "still here");
}

TEST_F(Strangers, GiveTheirPlaceBeforeOneWhoIsVouchedFor) {
    TestClient known;
    ASSERT_EQ(known.connect(server_.url()), UA_STATUSCODE_GOOD);
    ASSERT_EQ(known.echo("me"), "me");
    server_.inServer([this](UA_Server*) { server_.loop().vouchFor(server_.lastCaller()); });
    crowd("127.0.0.1", 50);
    EXPECT_EQ(known.echo("still here"), "still here");
}

TEST(StrangersInTime, AreClosedUnlessTheyAreAdmitted) {
    TestServer server({.loop = {.stranger_limit = 3s}});
    TestClient member;
    ASSERT_EQ(member.connect(server.url()), UA_STATUSCODE_GOOD);
    ASSERT_EQ(member.echo("me"), "me");
    const auto connection = server.inServer([&](UA_Server*) {
        server.loop().admit(server.lastCaller());
        return server.lastCaller();
    });
    const auto begin = std::chrono::steady_clock::now();
    const Stranger stranger(server.port(), "127.0.0.1");
    EXPECT_EQ(stranger.lastWords(), "");
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 2900ms);
    EXPECT_EQ(member.echo("still here"), "still here");

    server.inServer([&](UA_Server*) { server.loop().dismiss(connection); });
    const auto deadline = std::chrono::steady_clock::now() + kDeadline;
    while (server.statistics().connections > 0 && std::chrono::steady_clock::now() < deadline) {
    }
    EXPECT_EQ(server.statistics().dropped_strangers, 2U);
}

}  // namespace
}  // namespace metier::opcua::testing
