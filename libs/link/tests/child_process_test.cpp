#include "metier/link/child_process.hpp"

#include <gmock/gmock.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <string>

namespace metier::link {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

SteadyTime soon() {
    return std::chrono::steady_clock::now() + 30s;
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

TEST(ChildProcess, IsInAGroupOfItsOwnIfAsked) {
    auto child = ChildProcess::start({"tail", "-f", "/dev/null"}, {.group = Group::own});
    ASSERT_TRUE(child);
    EXPECT_EQ(getpgid(child->pid()), child->pid());
    auto other = ChildProcess::start({"tail", "-f", "/dev/null"});
    ASSERT_TRUE(other);
    EXPECT_EQ(getpgid(other->pid()), getpgrp());
}

/// Starts a child in a process of its own, which then dies as by kill -9.
/// \return what the child printed when it was signalled
std::string lastWordsOfOrphan(int on_owners_death) {
    std::array<int, 2> words{};
    if (pipe(words.data()) != 0) {
        return "no pipe";
    }
    const pid_t owner = fork();
    if (owner == 0) {
        const auto script = "trap 'echo signalled >&" + std::to_string(words[1]) +
                            "; exit' TERM; echo ready; while :; do sleep 0.01; done";
        auto child =
            ChildProcess::start({"sh", "-c", script}, {.on_owners_death = on_owners_death});
        if (!child || !child->readLine(soon())) {
            _exit(1);
        }
        kill(getpid(), SIGKILL);
    }
    close(words[1]);
    std::string said;
    std::array<char, 64> part{};
    for (ssize_t count = 0; (count = read(words[0], part.data(), part.size())) > 0;) {
        said.append(part.data(), static_cast<std::size_t>(count));
    }
    close(words[0]);
    int status = 0;
    waitpid(owner, &status, 0);
    return WIFSIGNALED(status) ? said : "the owner could not start it";
}

TEST(ChildProcess, MayEndByItselfWhenItsOwnerDies) {
    EXPECT_EQ(lastWordsOfOrphan(SIGTERM), "signalled\n");
}

TEST(ChildProcess, IsKilledWhenItsOwnerDiesUnlessAskedOtherwise) {
    EXPECT_EQ(lastWordsOfOrphan(ChildOptions().on_owners_death), "");
}

TEST(ChildProcess, ShowsItsEndByADescriptor) {
    auto child = ChildProcess::start({"tail", "-f", "/dev/null"});
    ASSERT_TRUE(child);
    pollfd request{child->endDescriptor(), POLLIN, 0};
    EXPECT_EQ(poll(&request, 1, 0), 0);
    child->signal(SIGKILL);
    EXPECT_EQ(poll(&request, 1, 30'000), 1);
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
}  // namespace metier::link
