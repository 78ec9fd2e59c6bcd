#include "metier/link/link_guard.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill() is POSIX, not in <csignal>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

namespace metier::link {
namespace {

using namespace std::chrono_literals;

constexpr auto kLimit = 100ms;
// Limit for an owner that works, on a machine that may make it wait for long.
constexpr auto kPatient = 1000ms;
constexpr auto kNever = 1h;
constexpr int kAttempts = 20;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

struct Pair {
    TcpListener listener = TcpListener::listen("127.0.0.1", 0).value();
    TcpLink near = TcpLink::connect("127.0.0.1", listener.port(), in(30s)).value();
    TcpLink far = listener.accept(in(30s)).value();
};

bool closedWithin(TcpLink& link, std::chrono::milliseconds time) {
    std::array<std::byte, 16> buffer{};
    const auto received = link.receive(buffer, in(time));
    return !received && received.error().code == Errc::connection_lost;
}

LinkGuard startGuard(std::chrono::milliseconds limit) {
    return LinkGuard::start(limit).value();
}

/// Notices that the computer held this process up, so that it did not look like an owner that
/// works.
class Pulse {
public:
    void beat() {
        const auto now = std::chrono::steady_clock::now();
        longest_ = std::max(longest_, now - last_);
        last_ = now;
    }
    bool heldUp() const { return longest_ > kPatient / 2; }

private:
    SteadyTime last_ = std::chrono::steady_clock::now();
    SteadyTime::duration longest_{};
};

TEST(LinkGuard, EndsALinkWhoseOwnerDoesNotWork) {
    Pair pair;
    auto guard = startGuard(kLimit);
    const auto before = std::chrono::steady_clock::now();
    ASSERT_TRUE(guard.guard(pair.near));
    EXPECT_TRUE(closedWithin(pair.far, 10s));
    EXPECT_GT(std::chrono::steady_clock::now() - before, kLimit / 2);
    EXPECT_TRUE(closedWithin(pair.near, 10s)) << "its owner learns of it";
}

/// Whether a link stays beyond its guard's limit; nothing if its owner was held up.
std::optional<bool> staysWhileItsOwnerWorks() {
    Pair pair;
    auto guard = startGuard(kPatient);
    Pulse pulse;
    EXPECT_TRUE(guard.guard(pair.near));
    bool stays = true;
    for (const auto end = in(3 * kPatient / 2); stays && std::chrono::steady_clock::now() < end;) {
        guard.alive();
        pulse.beat();
        stays = !closedWithin(pair.far, 2ms);
    }
    pulse.beat();
    return !stays && pulse.heldUp() ? std::nullopt : std::optional(stays);
}

TEST(LinkGuard, LeavesALinkWhoseOwnerWorks) {
    std::optional<bool> stays;
    for (int attempt = 0; !stays && attempt < kAttempts; ++attempt) {
        stays = staysWhileItsOwnerWorks();
    }
    EXPECT_EQ(stays, true);
}

/// A link that was guarded for much less than the limit.
std::unique_ptr<Pair> releasedInTime(LinkGuard& guard) {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        auto pair = std::make_unique<Pair>();
        const auto before = std::chrono::steady_clock::now();
        EXPECT_TRUE(guard.guard(pair->near));
        guard.release();
        if (std::chrono::steady_clock::now() - before < kLimit / 2) {
            return pair;
        }
    }
    return nullptr;
}

TEST(LinkGuard, LeavesALinkThatItNoLongerGuards) {
    auto guard = startGuard(kLimit);
    const auto pair = releasedInTime(guard);
    ASSERT_TRUE(pair);
    EXPECT_FALSE(closedWithin(pair->far, 3 * kLimit));
    Pair other;
    ASSERT_TRUE(guard.guard(other.near));
    EXPECT_TRUE(closedWithin(other.far, 10s));
    EXPECT_FALSE(closedWithin(pair->far, 0ms));
}

/// A process that guards a link and works, until it is stopped or killed.
class Owner {
public:
    explicit Owner(Pair& pair) {
        std::array<int, 2> told{};
        EXPECT_EQ(pipe(told.data()), 0);
        report_ = told[0];
        pid_ = fork();
        if (pid_ == 0) {
            work(pair, told[1]);
        }
        close(told[1]);
        EXPECT_EQ(read(report_, &guard_, sizeof guard_), static_cast<ssize_t>(sizeof guard_));
        EXPECT_GT(guard_, 0);
        handle_ = static_cast<int>(syscall(SYS_pidfd_open, guard_, 0));
    }
    ~Owner() {
        kill();
        close(report_);
        close(handle_);
    }
    Owner(const Owner&) = delete;
    Owner& operator=(const Owner&) = delete;

    void stop() { ::kill(pid_, SIGSTOP); }
    void kill() {
        if (pid_ > 0) {
            ::kill(pid_, SIGKILL);
            waitpid(std::exchange(pid_, -1), nullptr, 0);
        }
    }
    /// Whether the computer held it up; waits for the news of it.
    bool wasHeldUp() const {
        pollfd news{report_, POLLIN, 0};
        return poll(&news, 1, 10'000) == 1 && (news.revents & POLLIN) != 0;
    }
    bool guardIsGone() const {
        pollfd ended{handle_, POLLIN, 0};
        return poll(&ended, 1, 10'000) == 1;
    }

private:
    [[noreturn]] static void work(Pair& pair, int report) {
        auto guard = LinkGuard::start(kPatient);
        Pulse pulse;
        const bool guarded = guard && guard->guard(pair.near);
        const pid_t pid = guarded ? guard->pid() : -1;
        [[maybe_unused]] auto written = write(report, &pid, sizeof pid);
        for (bool reported = false;;) {
            guard->alive();
            pulse.beat();
            if (pulse.heldUp() && !std::exchange(reported, true)) {
                written = write(report, "x", 1);
            }
        }
    }

    int report_ = -1;
    int handle_ = -1;
    pid_t pid_ = -1;
    pid_t guard_ = -1;
};

TEST(LinkGuard, EndsTheLinkOfAnOwnerThatIsStoppedAndEndsWithOneThatIsKilled) {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        Pair pair;
        Owner owner(pair);
        if (closedWithin(pair.far, 3 * kPatient / 2)) {
            ASSERT_TRUE(owner.wasHeldUp()) << "its owner works";
            continue;
        }
        owner.stop();
        EXPECT_TRUE(closedWithin(pair.far, 10s));
        owner.kill();
        EXPECT_TRUE(owner.guardIsGone());
        return;
    }
    FAIL() << "its owner was held up each time";
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
