#include "event_loop.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

#include "delayed_callbacks.hpp"
#include "message_counter.hpp"

namespace metier::opcua {

namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kThreads = 8;
constexpr int kPosts = 1000;  // each

TEST(EventLoop, RunsWhatEightThreadsPostOnItsOwnThread) {
    AsioEventLoop loop;
    loop.handle()->start(loop.handle());
    int ran = 0;  // only the owner thread counts
    std::vector<std::jthread> threads;
    const auto post_all = [&] {
        for (int i = 0; i < kPosts; ++i) {
            loop.post([&] { ++ran; });
        }
    };
    threads.reserve(kThreads);
    for (int i = 0; i < kThreads; ++i) {
        threads.emplace_back(post_all);
    }
    const auto deadline = std::chrono::steady_clock::now() + 10s;
    while (ran < kThreads * kPosts && std::chrono::steady_clock::now() < deadline) {
        ASSERT_TRUE(loop.runOnce(1s));
    }
    EXPECT_EQ(ran, kThreads * kPosts);
}

TEST(EventLoop, IsWokenByAPost) {
    AsioEventLoop loop;
    loop.handle()->start(loop.handle());
    bool ran = false;
    std::jthread other([&] { loop.post([&] { ran = true; }); });
    const auto start = std::chrono::steady_clock::now();
    while (!ran && std::chrono::steady_clock::now() - start < 10s) {
        ASSERT_TRUE(loop.runOnce(60s));
    }
    EXPECT_LT(std::chrono::steady_clock::now() - start, 10s);
}

TEST(EventLoop, RunsOnlyBetweenStartAndStop) {
    AsioEventLoop loop;
    EXPECT_FALSE(loop.runOnce(0ms));
    loop.handle()->start(loop.handle());
    EXPECT_TRUE(loop.runOnce(0ms));
    loop.handle()->stop(loop.handle());
    EXPECT_EQ(loop.handle()->state, UA_EVENTLOOPSTATE_STOPPED);
    EXPECT_FALSE(loop.runOnce(0ms));
    EXPECT_EQ(loop.handle()->start(loop.handle()), UA_STATUSCODE_GOOD);
    EXPECT_TRUE(loop.runOnce(0ms));
}

TEST(EventLoop, RefusesToRunInsideItself) {
    AsioEventLoop loop;
    loop.handle()->start(loop.handle());
    bool refused = false;
    loop.post([&] { refused = !loop.runOnce(0ms); });
    ASSERT_TRUE(loop.runOnce(1s));
    EXPECT_TRUE(refused);
}

TEST(EventLoop, ReportsWhatAHandlerThrewAndGoesOn) {
    AsioEventLoop loop;
    loop.handle()->start(loop.handle());
    bool ran = false;
    loop.post([] { throw std::runtime_error("no"); });
    loop.post([&] { ran = true; });
    const auto failed = loop.runOnce(1s);
    ASSERT_FALSE(failed);
    EXPECT_THAT(failed.error().message, HasSubstr("BadInternalError"));
    EXPECT_TRUE(loop.runOnce(1s));
    EXPECT_TRUE(ran);
}

TEST(EventLoop, TellsOtherThreadsWhenItLastIterated) {
    AsioEventLoop loop;
    loop.handle()->start(loop.handle());
    const auto before = std::chrono::steady_clock::now();
    ASSERT_TRUE(loop.runOnce(0ms));
    SteadyTime seen{};
    std::jthread([&] { seen = loop.lastIteration(); }).join();
    EXPECT_GE(seen, before);
}

TEST(EventLoop, RefusesEventSourcesThatAreNotItsOwn) {
    AsioEventLoop loop;
    UA_EventSource foreign{};
    EXPECT_EQ(loop.handle()->registerEventSource(loop.handle(), &foreign),
              UA_STATUSCODE_BADNOTSUPPORTED);
}

/// Delayed callbacks that note their name when they run.
class Delayed : public ::testing::Test {
protected:
    struct Named {
        UA_DelayedCallback callback{};
        Delayed* test = nullptr;
        char name = 0;
        std::function<void()> then;
    };
    Named make(char name, std::function<void()> then = {}) {
        return {{nullptr, run, nullptr, nullptr}, this, name, std::move(then)};
    }
    void add(Named& named) {
        named.callback.context = &named;
        callbacks_.add(&named.callback);
    }
    static void run(void* /*application*/, void* context) {
        auto& named = *static_cast<Named*>(context);
        named.test->ran_.push_back(named.name);
        if (named.then) {
            named.then();
        }
    }

    DelayedCallbacks callbacks_;
    std::vector<char> ran_;
};

TEST_F(Delayed, RunInTheOrderTheyWereAddedAndOnce) {
    auto a = make('a');
    auto b = make('b');
    add(a);
    add(b);
    callbacks_.run();
    callbacks_.run();
    EXPECT_THAT(ran_, ElementsAre('a', 'b'));
}

TEST_F(Delayed, WhatOneAddsWaitsForTheNextRun) {
    auto b = make('b');
    auto a = make('a', [&] { add(b); });
    add(a);
    callbacks_.run();
    EXPECT_THAT(ran_, ElementsAre('a'));
    EXPECT_FALSE(callbacks_.empty());
    callbacks_.run();
    EXPECT_THAT(ran_, ElementsAre('a', 'b'));
}

TEST_F(Delayed, OneMayRemoveAnotherThatWaitsInTheSameRun) {
    auto b = make('b');
    auto a = make('a', [&] { callbacks_.remove(&b.callback); });
    add(a);
    add(b);
    callbacks_.run();
    EXPECT_THAT(ran_, ElementsAre('a'));
}

std::vector<std::uint8_t> chunk(const char* type, std::size_t size) {
    std::vector<std::uint8_t> bytes(type, type + 4);
    for (unsigned i = 0; i < 4; ++i) {
        bytes.push_back(static_cast<std::uint8_t>(size >> (8 * i)));
    }
    bytes.resize(std::max<std::size_t>(size, 8), 0x4D);
    return bytes;
}

std::vector<std::uint8_t> join(std::initializer_list<std::vector<std::uint8_t>> parts) {
    std::vector<std::uint8_t> all;
    for (const auto& part : parts) {
        all.insert(all.end(), part.begin(), part.end());
    }
    return all;
}

TEST(MessageCounter, CountsServiceMessagesNotTheirChunks) {
    const auto stream = join({chunk("HELF", 32), chunk("OPNF", 132), chunk("MSGC", 700),
                              chunk("MSGF", 20), chunk("MSGA", 30), chunk("CLOF", 57)});
    EXPECT_EQ(MessageCounter().feed(stream), 2);
}

TEST(MessageCounter, DoesNotMindWhereTheStreamIsCut) {
    const auto stream = join({chunk("MSGF", 8), chunk("MSGC", 70'000), chunk("MSGF", 300)});
    for (const std::size_t step : {1U, 3U, 7U, 8U, 64U, 65'536U}) {
        MessageCounter counter;
        std::size_t messages = 0;
        for (std::size_t at = 0; at < stream.size(); at += step) {
            messages +=
                counter.feed(std::span(stream).subspan(at, std::min(step, stream.size() - at)));
        }
        EXPECT_EQ(messages, 2) << step;
    }
}

TEST(MessageCounter, EndsAtASizeNoChunkCanHave) {
    const auto stream = join({chunk("MSGF", 7), chunk("MSGF", 20)});
    EXPECT_EQ(MessageCounter().feed(stream), 0);
}

}  // namespace

}  // namespace metier::opcua
