#include "metier/link/link_guard.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill() is POSIX, not in <csignal>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>

namespace metier::link {
namespace {

using namespace std::chrono_literals;

constexpr auto kLimit = 100ms;
// Limit for an owner that works, on a machine that may make it wait for long.
constexpr auto kPatient = 1000ms;
constexpr auto kNever = 1h;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

struct Pair {
    TcpListener listener = TcpListener::listen("127.0.0.1", 0).value();
    TcpLink near = TcpLink::connect("127.0.0.1", listener.port(), in(5s)).value();
    TcpLink far = listener.accept(in(5s)).value();
};

bool closedWithin(TcpLink& link, std::chrono::milliseconds time) {
    std::array<std::byte, 16> buffer{};
    const auto received = link.receive(buffer, in(time));
    return !received && received.error().code == Errc::connection_lost;
}

LinkGuard startGuard(std::chrono::milliseconds limit) {
    return LinkGuard::start(limit).value();
}

TEST(LinkGuard, EndsALinkWhoseOwnerDoesNotWork) {
    Pair pair;
    auto guard = startGuard(kLimit);
    ASSERT_TRUE(guard.guard(pair.near));
    const auto before = std::chrono::steady_clock::now();
    EXPECT_TRUE(closedWithin(pair.far, 10s));
    EXPECT_GT(std::chrono::steady_clock::now() - before, kLimit / 2);
    EXPECT_TRUE(closedWithin(pair.near, 10s)) << "its owner learns of it";
}

TEST(LinkGuard, LeavesALinkWhoseOwnerWorks) {
    Pair pair;
    auto guard = startGuard(kPatient);
    ASSERT_TRUE(guard.guard(pair.near));
    const auto end = in(3 * kPatient / 2);
    while (std::chrono::steady_clock::now() < end) {
        guard.alive();
        ASSERT_FALSE(closedWithin(pair.far, 2ms));
    }
}

TEST(LinkGuard, LeavesALinkThatItNoLongerGuards) {
    Pair pair;
    auto guard = startGuard(kLimit);
    ASSERT_TRUE(guard.guard(pair.near));
    guard.release();
    EXPECT_FALSE(closedWithin(pair.far, 3 * kLimit));
    Pair other;
    ASSERT_TRUE(guard.guard(other.near));
    EXPECT_TRUE(closedWithin(other.far, 10s));
    EXPECT_FALSE(closedWithin(pair.far, 0ms));
}

TEST(LinkGuard, EndsTheLinkOfAnOwnerThatIsStoppedAndEndsWithOneThatIsKilled) {
    Pair pair;
    std::array<int, 2> told{};
    ASSERT_EQ(pipe(told.data()), 0);
    const pid_t owner = fork();
    if (owner == 0) {
        auto guard = LinkGuard::start(kPatient);
        const bool guarded = guard && guard->guard(pair.near);
        const pid_t pid = guarded ? guard->pid() : -1;
        [[maybe_unused]] const auto written = write(told[1], &pid, sizeof pid);
        for (;;) {
            guard->alive();
        }
    }
    pid_t guard = -1;
    ASSERT_EQ(read(told[0], &guard, sizeof guard), static_cast<ssize_t>(sizeof guard));
    ASSERT_GT(guard, 0);
    const auto handle = static_cast<int>(syscall(SYS_pidfd_open, guard, 0));
    EXPECT_FALSE(closedWithin(pair.far, 3 * kPatient / 2)) << "its owner works";
    kill(owner, SIGSTOP);
    EXPECT_TRUE(closedWithin(pair.far, 10s));
    kill(owner, SIGKILL);
    waitpid(owner, nullptr, 0);
    pollfd ended{handle, POLLIN, 0};
    EXPECT_EQ(poll(&ended, 1, 10'000), 1) << "the guard is gone";
    close(handle);
    close(told[0]);
    close(told[1]);
}

TEST(LinkGuard, KeepsNothingOpenButTheLink) {
    std::array<int, 2> ends{};
    ASSERT_EQ(pipe(ends.data()), 0);
    const auto guard = startGuard(std::chrono::duration_cast<std::chrono::milliseconds>(kNever));
    close(ends[1]);
    pollfd reading{ends[0], 0, 0};
    EXPECT_EQ(poll(&reading, 1, 10'000), 1) << "nobody else can write";
    EXPECT_NE(reading.revents & POLLHUP, 0);
    close(ends[0]);
}

TEST(LinkGuard, TellsThatItsProcessIsGone) {
    Pair pair;
    auto guard = startGuard(kLimit);
    const auto handle = static_cast<int>(syscall(SYS_pidfd_open, guard.pid(), 0));
    kill(guard.pid(), SIGKILL);
    pollfd ended{handle, POLLIN, 0};
    ASSERT_EQ(poll(&ended, 1, 10'000), 1);
    close(handle);
    const auto refused = guard.guard(pair.near);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::resource_unavailable);
}

}  // namespace
}  // namespace metier::link
