#include "metier/link/stop_signal.hpp"

#include <gtest/gtest.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill() is POSIX, not in <csignal>
#include <unistd.h>

#include <array>
#include <chrono>
#include <optional>

#include "metier/link/start_watch.hpp"

namespace metier::link {
namespace {

using namespace std::chrono_literals;
using ::testing::ExitedWithCode;
using ::testing::KilledBySignal;

/// Each in a process of its own, since signals stay blocked.
class StopSignalDeathTest : public ::testing::TestWithParam<int> {
protected:
    StopSignalDeathTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_P(StopSignalDeathTest, IsWaitedFor) {
    EXPECT_EXIT(
        {
            const StopSignal stop;
            const bool before = stop.came();
            kill(getpid(), GetParam());
            stop.wait();
            _exit(!before && stop.came() ? 7 : 8);
        },
        ExitedWithCode(7), "");
}

TEST_P(StopSignalDeathTest, EndsAStartThatWaitsForEver) {
    EXPECT_EXIT(
        {
            const StopSignal stop;
            const StartWatch watch(stop);
            kill(getpid(), GetParam());
            for (;;) {
                pause();
            }
        },
        ExitedWithCode(1), "stopped before it was ready");
}

TEST_P(StopSignalDeathTest, LetsAStartEndInItsOwnWay) {
    EXPECT_EXIT(
        {
            const StopSignal stop;
            std::optional<StartWatch> watch(std::in_place, stop, 1h);
            kill(getpid(), GetParam());
            stop.wait();
            watch.reset();
            _exit(stop.waitUntil(std::chrono::steady_clock::now() + 1s) ? 7 : 8);
        },
        ExitedWithCode(7), "^$");
}

INSTANTIATE_TEST_SUITE_P(Signals, StopSignalDeathTest, ::testing::Values(SIGINT, SIGTERM, SIGHUP));

bool writesToNobody() {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) {
        return true;
    }
    close(ends[0]);
    return write(ends[1], "x", 1) >= 0;
}

class ProgramsEndDeathTest : public ::testing::Test {
protected:
    ProgramsEndDeathTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(ProgramsEndDeathTest, IsBounded) {
    EXPECT_EXIT(
        {
            const StopSignal stop;
            StopSignal::endWithin(1s);
            for (;;) {
                pause();
            }
        },
        KilledBySignal(SIGALRM), "");
}

TEST_F(ProgramsEndDeathTest, IsNotThatOfItsOutput) {
    EXPECT_EXIT(
        {
            StopSignal::outliveOutput();
            _exit(writesToNobody() ? 8 : 7);
        },
        ExitedWithCode(7), "");
}

}  // namespace
}  // namespace metier::link
