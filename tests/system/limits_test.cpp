// Limits of a server for its clients: at the limit it serves, one beyond is refused with the
// StatusCode that OPC 10000-4 (for messages: OPC 10000-6) names. The clients are plain sockets.
#include <gmock/gmock.h>

#include "attacks/requests.hpp"
#include "bench_server.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kGood = 0;
constexpr std::uint32_t kBadTooManyOperations = 0x80100000;
constexpr std::uint32_t kBadTooManySessions = 0x80560000;
constexpr std::uint32_t kBadTooManySubscriptions = 0x80770000;
constexpr std::uint32_t kBadTooManyPublishRequests = 0x80780000;
constexpr std::uint32_t kBadTcpMessageTooLarge = 0x80800000;
constexpr std::uint32_t kBadTooManyMonitoredItems = 0x80DB0000;

class Limits : public ::testing::Test {
protected:
    static opcua::ServerLimits few() {
        opcua::ServerLimits limits;
        limits.secure_channels = 5;
        limits.sessions = 3;
        limits.session_timeout = 7s;
        limits.message_size = 64 * 1024;
        limits.chunks_per_message = 4;
        limits.subscriptions = 3;
        limits.subscriptions_per_session = 2;
        limits.monitored_items = 8;
        limits.monitored_items_per_subscription = 5;
        limits.event_queue = 7;
        limits.min_publishing_interval = 20ms;
        limits.max_publishing_interval = 200ms;
        limits.lifetime_count = 3'000;  // a minute at the shortest interval
        limits.publish_requests_per_session = 4;
        limits.nodes_per_read = 6;
        limits.nodes_per_write = 5;
        limits.nodes_per_call = 4;
        limits.nodes_per_browse = 3;
        return limits;
    }
    Limits() : server_({.limits = few()}) {
        skill::SkillDescription description;
        description.name = "Limited";
        description.type = "PositionStreamSkillType";
        server_.addSkill(std::move(description), {});
        server_.serve();
    }

    RawPeer stranger() const { return {"127.0.0.1", server_.port(), 0, 30s}; }
    RawPeer member() const {
        auto peer = stranger();
        EXPECT_TRUE(peer.logIn());
        return peer;
    }
    WireBytes calls(std::size_t count) const {
        const auto skill = server_.node("Limited");
        return callOf(
            {skill.namespaceIndex(), std::get<std::string>(skill.identifier()), "Reset", count});
    }
    /// StatusCodes of the items that a Subscription was to get.
    static std::vector<std::uint32_t> itemResults(RawPeer& peer, std::uint32_t subscription,
                                                  const Items& items) {
        constexpr std::size_t kResult = 4 + 4 + 8 + 4 + 3;  // no filter result
        std::vector<std::uint32_t> results;
        const auto answer = peer.ask(request::kCreateMonitoredItems, itemsOf(subscription, items));
        for (std::size_t i = 0; answer && i < numberAt(*answer, 0); ++i) {
            results.push_back(numberAt(*answer, 4 + i * kResult));
        }
        return results;
    }

    BenchServer server_;
};

TEST_F(Limits, OfSessions) {
    std::vector<RawPeer> members;
    for (int i = 0; i < 3; ++i) {
        members.push_back(member());
    }
    auto one_more = stranger();
    ASSERT_TRUE(one_more.hello() && one_more.openChannel());
    EXPECT_EQ(one_more.statusOf(request::kCreateSession, sessionOf(1h)), kBadTooManySessions);
    EXPECT_EQ(members.front().statusOf(request::kRead, readOf(1)), kGood);
}

TEST_F(Limits, OfSessionsThatAreNeverActivatedTakeNoPlace) {
    auto hoarder = stranger();
    ASSERT_TRUE(hoarder.hello() && hoarder.openChannel());
    for (int i = 0; i < 20; ++i) {
        EXPECT_EQ(hoarder.statusOf(request::kCreateSession, sessionOf(1h)), kGood) << i;
    }
    std::vector<RawPeer> members;
    for (int i = 0; i < 3; ++i) {
        members.push_back(member());
        EXPECT_EQ(members.back().statusOf(request::kRead, readOf(1)), kGood) << i;
    }
    EXPECT_EQ(hoarder.statusOf(request::kCreateSession, sessionOf(1h)), kBadTooManySessions)
        << "all places are taken by sessions that are used";
}

TEST_F(Limits, OfTheSessionTimeout) {
    auto peer = stranger();
    ASSERT_TRUE(peer.hello() && peer.openChannel());
    ASSERT_EQ(peer.statusOf(request::kCreateSession, sessionOf(1h)), kGood);
    EXPECT_EQ(sessionTimeout(peer.answer()), 7s);
    auto modest = stranger();
    ASSERT_TRUE(modest.hello() && modest.openChannel());
    ASSERT_EQ(modest.statusOf(request::kCreateSession, sessionOf(7s - 1ms)), kGood);
    EXPECT_EQ(sessionTimeout(modest.answer()), 7s - 1ms);
}

TEST_F(Limits, OfConnectionsWhoseSessionsKeepTheirPlaces) {
    std::vector<RawPeer> members;
    for (int i = 0; i < 3; ++i) {
        members.push_back(member());
    }
    std::vector<RawPeer> strangers;
    for (int i = 0; i < 20; ++i) {
        strangers.push_back(stranger());
    }
    EXPECT_TRUE(stranger().hello());
    for (auto& peer : members) {
        EXPECT_EQ(peer.statusOf(request::kRead, readOf(1)), kGood);
    }
}

TEST_F(Limits, OfOperations) {
    struct Operation {
        const char* name;
        std::uint16_t type;
        std::size_t most;
        std::function<WireBytes(std::size_t)> body;
    };
    auto peer = member();
    const auto subscription = subscribe(peer).value();
    const std::vector<Operation> operations{
        {"Read", request::kRead, 6, readOf},
        {"Write", request::kWrite, 5, writeOf},
        {"Browse", request::kBrowse, 3, browseOf},
        {"Call", request::kCall, 4, [this](std::size_t count) { return calls(count); }},
        {"CreateMonitoredItems", request::kCreateMonitoredItems, 5,
         [&](std::size_t count) { return itemsOf(subscription, {.count = count}); }}};
    for (const auto& operation : operations) {
        EXPECT_EQ(peer.statusOf(operation.type, operation.body(operation.most)), kGood)
            << operation.name;
        EXPECT_EQ(peer.statusOf(operation.type, operation.body(operation.most + 1)),
                  kBadTooManyOperations)
            << operation.name;
    }
}

TEST_F(Limits, OfSubscriptions) {
    auto peer = member();
    EXPECT_TRUE(subscribe(peer));
    EXPECT_TRUE(subscribe(peer));
    const auto body = subscriptionOf({});
    EXPECT_EQ(peer.statusOf(request::kCreateSubscription, body), kBadTooManySubscriptions);
    auto other = member();
    EXPECT_TRUE(subscribe(other));  // the last one of all
    EXPECT_EQ(other.statusOf(request::kCreateSubscription, body), kBadTooManySubscriptions);
}

TEST_F(Limits, OfThePublishingIntervalAndOfTheLifetime) {
    struct Revised {
        Subscribing asked;
        double interval_ms;
        std::uint32_t lifetime_count;
    };
    for (const auto& [asked, interval_ms, lifetime_count] :
         {Revised{{20.0, 3'000}, 20.0, 3'000}, Revised{{19.0, 3'001}, 20.0, 3'000},
          Revised{{200.0, 3'000}, 200.0, 3'000}, Revised{{201.0, 3'001}, 200.0, 3'000}}) {
        auto peer = member();
        ASSERT_EQ(peer.statusOf(request::kCreateSubscription, subscriptionOf(asked)), kGood);
        EXPECT_EQ(doubleAt(peer.answer(), 4), interval_ms);
        EXPECT_EQ(numberAt(peer.answer(), 12), lifetime_count);
        peer.closeSession();
    }
}

TEST_F(Limits, OfMonitoredItems) {
    auto peer = member();
    const auto first = subscribe(peer).value();
    const auto second = subscribe(peer).value();
    EXPECT_THAT(itemResults(peer, first, {.count = 5}), ::testing::Each(kGood));
    EXPECT_THAT(itemResults(peer, first, {.count = 1}),
                ::testing::ElementsAre(kBadTooManyMonitoredItems));
    EXPECT_THAT(itemResults(peer, second, {.count = 4}),  // 8 of all
                ::testing::ElementsAre(kGood, kGood, kGood, kBadTooManyMonitoredItems));
}

TEST_F(Limits, OfTheQueueOfAnItem) {
    auto peer = member();
    const auto subscription = subscribe(peer).value();
    constexpr std::size_t kRevisedQueue = 4 + 4 + 4 + 8;
    for (const auto& [asked, revised] : {std::pair{6U, 6U}, std::pair{7U, 7U}, std::pair{8U, 7U}}) {
        const auto answer =
            peer.ask(request::kCreateMonitoredItems, itemsOf(subscription, {.queue = asked}));
        ASSERT_TRUE(answer);
        EXPECT_EQ(numberAt(*answer, kRevisedQueue), revised);
    }
}

// The oldest request is answered when one too many comes (OPC 10000-4, 5.14.5).
TEST_F(Limits, OfPublishRequests) {
    auto peer = member();
    ASSERT_TRUE(subscribe(peer));
    for (int i = 0; i < 4; ++i) {
        ASSERT_TRUE(peer.request(request::kPublish, publish()));
    }
    // Keep-alives of the Subscription, the first after 20 ms, take requests as well.
    constexpr int kKeepAlives = 20;
    auto status = peer.statusOf(request::kPublish, publish());
    for (int i = 0; status == kGood && i < kKeepAlives; ++i) {
        status = peer.statusOf(request::kPublish, publish());
    }
    EXPECT_EQ(status, kBadTooManyPublishRequests);
}

TEST_F(Limits, OfTheSizeOfAMessage) {
    const std::string text(64 * 1024 - 200, 'x');
    auto peer = stranger();
    ASSERT_TRUE(peer.hello() && peer.openChannel());
    EXPECT_EQ(peer.statusInChunks(request::kCreateSession, sessionOf(1h, text), 2), kGood);
    auto greedy = stranger();
    ASSERT_TRUE(greedy.hello() && greedy.openChannel());
    EXPECT_EQ(greedy.statusInChunks(request::kCreateSession, sessionOf(1h, text + text), 3),
              kBadTcpMessageTooLarge);
}

// The stack counts all but the last.
TEST_F(Limits, OfTheChunksOfAMessage) {
    auto peer = stranger();
    ASSERT_TRUE(peer.hello() && peer.openChannel());
    EXPECT_EQ(peer.statusInChunks(request::kCreateSession, sessionOf(1h), 4), kGood);
    auto greedy = stranger();
    ASSERT_TRUE(greedy.hello() && greedy.openChannel());
    EXPECT_EQ(greedy.statusInChunks(request::kCreateSession, sessionOf(1h), 6),
              kBadTcpMessageTooLarge);
}

}  // namespace
}  // namespace metier::system_tests
