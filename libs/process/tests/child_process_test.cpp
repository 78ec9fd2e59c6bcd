#include "metier/process/child_process.hpp"

#include <gmock/gmock.h>

#include <csignal>

namespace metier::process {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

SteadyTime soon() {
    return std::chrono::steady_clock::now() + 5s;
}

TEST(ChildProcess, GivesTheLinesOfItsOutput) {
    auto child = ChildProcess::start({"sh", "-c", "echo one; echo two"});
    ASSERT_TRUE(child);
    EXPECT_EQ(child->readLine(soon()).value(), "one");
    EXPECT_EQ(child->readLine(soon()).value(), "two");
    const auto end = child->readLine(soon());
    ASSERT_FALSE(end);
    EXPECT_EQ(end.error().code, Errc::connection_lost);
}

TEST(ChildProcess, TellsItsExitStatus) {
    auto child = ChildProcess::start({"sh", "-c", "exit 7"});
    ASSERT_TRUE(child);
    EXPECT_EQ(child->waitUntil(soon()), 7);
    EXPECT_FALSE(child->running());
}

TEST(ChildProcess, TellsTheSignalThatEndedIt) {
    auto child = ChildProcess::start({"cat", "/dev/zero"});
    ASSERT_TRUE(child);
    EXPECT_TRUE(child->running());
    child->signal(SIGKILL);
    EXPECT_EQ(child->waitUntil(soon()), 128 + SIGKILL);
}

TEST(ChildProcess, RefusesAProgramThatDoesNotExist) {
    const auto child = ChildProcess::start({"/nonexistent/program"});
    ASSERT_FALSE(child);
    EXPECT_EQ(child.error().code, Errc::not_found);
    EXPECT_THAT(child.error().message, HasSubstr("/nonexistent/program"));
}

TEST(ChildProcess, StopsReadingAtTheDeadline) {
    auto child = ChildProcess::start({"tail", "-f", "/dev/null"});
    ASSERT_TRUE(child);
    const auto line = child->readLine(std::chrono::steady_clock::now() + 10ms);
    ASSERT_FALSE(line);
    EXPECT_EQ(line.error().code, Errc::timeout);
}

TEST(ChildProcess, EndsWithItsOwner) {
    pid_t pid = 0;
    {
        auto child = ChildProcess::start({"tail", "-f", "/dev/null"});
        ASSERT_TRUE(child);
        pid = child->pid();
        EXPECT_EQ(kill(pid, 0), 0);
    }
    EXPECT_NE(kill(pid, 0), 0);
}

TEST(ChildProcess, MovesWithWhatItOwns) {
    auto child = ChildProcess::start({"sh", "-c", "echo started; exec tail -f /dev/null"});
    ASSERT_TRUE(child);
    ASSERT_EQ(child->readLine(soon()).value(), "started");
    auto moved = std::move(*child);
    moved.signal(SIGTERM);
    EXPECT_EQ(moved.waitUntil(soon()), 128 + SIGTERM);
}

}  // namespace
}  // namespace metier::process
