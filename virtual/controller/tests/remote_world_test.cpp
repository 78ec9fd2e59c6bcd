#include "metier/virtual_controller/remote_world.hpp"

#include <gmock/gmock.h>

#include <array>
#include <asio/executor_work_guard.hpp>
#include <asio/post.hpp>
#include <functional>
#include <memory>
#include <optional>

#include "metier/link/tcp_link.hpp"
#include "metier/virtual_controller/world_messages.hpp"

namespace metier::virtual_controller {
namespace {

using namespace std::chrono_literals;

SteadyTime soon() {
    return std::chrono::steady_clock::now() + 10s;
}

WorldEffect push(double force) {
    return {.wrench = {{force, 0.0, 0.0}, {0.0, 0.0, 0.0}}, .part_width = {}};
}

/// A controller's side of the world, whose other side is played by the test.
struct PlayedWorld : ::testing::Test {
    /// Runs the controller until it is so. False if it does not become so in time.
    bool until(const std::function<bool()>& so) {
        const auto end = soon();
        while (!so() && std::chrono::steady_clock::now() < end) {
            context.run_one_for(10ms);
        }
        return so();
    }
    bool untilPushed(double force) {
        return until([&] { return world->effect().wrench.force.x() == force; });
    }
    void report(double time) { world->report({.time = time}); }
    void connect() {
        report(0.0);
        peer = listener.accept(soon()).value();
        ASSERT_EQ(reportedTime(), 0.0);
    }
    /// Time of the next report that the world gets [s]; less than 0 if none comes.
    double reportedTime() {
        std::string line;
        std::array<char, 1> byte{};
        const auto end = soon();
        while (!line.ends_with('\n') && std::chrono::steady_clock::now() < end) {
            context.poll();
            const auto until = std::chrono::steady_clock::now() + 2ms;
            if (peer->receive(std::as_writable_bytes(std::span(byte)), until)) {
                line += byte[0];
            }
        }
        const auto got = reportOf(line);
        return got && got->name == "arm" ? got->report.time : -1.0;
    }
    /// Reports whether the controller has left this world.
    bool lost() {
        std::array<std::byte, 64> bytes{};
        const auto got = peer->receive(bytes, std::chrono::steady_clock::now() + 1ms);
        return !got && got.error().code == Errc::connection_lost;
    }
    void answer(std::string_view line) {
        ASSERT_TRUE(peer->send(std::as_bytes(std::span(line)), soon()));
    }

    asio::io_context context;
    asio::executor_work_guard<asio::io_context::executor_type> work =
        asio::make_work_guard(context);
    link::TcpListener listener = link::TcpListener::listen("127.0.0.1", 0).value();
    std::unique_ptr<RemoteWorld> world =
        std::make_unique<RemoteWorld>(context, "arm", "127.0.0.1", listener.port());
    std::optional<link::TcpLink> peer;
};

TEST_F(PlayedWorld, GetsTheNewestReportOnceItHasAnsweredTheOneBefore) {
    connect();
    report(1.0);
    report(2.0);
    report(3.0);
    answer(toLine(push(5.0)));
    EXPECT_EQ(reportedTime(), 3.0);
    EXPECT_EQ(world->effect().wrench.force.x(), 5.0);
}

TEST_F(PlayedWorld, KeepsItsEffectIfAnAnswerIsNone) {
    connect();
    answer(toLine(push(5.0)));
    ASSERT_TRUE(untilPushed(5.0));
    report(1.0);
    ASSERT_EQ(reportedTime(), 1.0);
    answer("{\"wrench\":[1]}\n");
    report(2.0);
    EXPECT_EQ(reportedTime(), 2.0) << "a bad answer is an answer";
    EXPECT_EQ(world->effect().wrench.force.x(), 5.0);
}

TEST_F(PlayedWorld, HasNoEffectOnceItIsGoneAndIsFoundAgain) {
    connect();
    answer(toLine(push(5.0)));
    ASSERT_TRUE(untilPushed(5.0));
    report(1.0);
    ASSERT_EQ(reportedTime(), 1.0);
    peer.reset();
    EXPECT_TRUE(untilPushed(0.0));
    report(2.0);
    ASSERT_TRUE(until([&] {
        auto next = listener.accept(std::chrono::steady_clock::now() + 1ms);
        if (next) {
            peer = std::move(*next);
        }
        return peer.has_value();
    }));
    EXPECT_EQ(reportedTime(), 2.0);
}

TEST_F(PlayedWorld, IsLeftIfItsAnswerDoesNotEnd) {
    connect();
    answer(std::string(5000, 'x'));
    ASSERT_TRUE(until([&] { return lost(); }));
}

TEST_F(PlayedWorld, GetsNothingMoreFromAControllerThatIsGone) {
    connect();
    answer(toLine(push(5.0)));
    ASSERT_TRUE(untilPushed(5.0));
    report(1.0);  // the system takes it at once, the handler is queued
    world.reset();
    work.reset();
    EXPECT_EQ(context.poll(), 1U);
    EXPECT_TRUE(context.stopped()) << "nothing else goes on";
}

TEST_F(PlayedWorld, AnswersInVainAControllerThatIsGone) {
    connect();
    answer(toLine(push(5.0)));
    ASSERT_TRUE(untilPushed(5.0));
    answer(toLine(push(6.0)));  // before it is asked: it is read at once, its handler is queued
    report(1.0);
    asio::post(context, [this] { world.reset(); });
    work.reset();
    context.run_for(10s);
    EXPECT_TRUE(context.stopped()) << "nothing else goes on";
    EXPECT_FALSE(world);
}

}  // namespace
}  // namespace metier::virtual_controller
