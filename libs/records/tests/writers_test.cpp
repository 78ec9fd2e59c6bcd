// Servers as processes of their own: killed, and several with one store.
#include <gmock/gmock.h>

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <map>
#include <set>

#include "lateness.hpp"
#include "metier/link/child_process.hpp"
#include "recorded.hpp"
#include "socket_deadline.hpp"
#include "temporary_postgres.hpp"

namespace metier::records {
namespace {

using namespace std::chrono_literals;
using link::ChildProcess;

std::string postgresOrNothing() {
    auto* postgres = TemporaryPostgres::instance();
    return postgres == nullptr ? std::string() : postgres->freshDatabase();
}

ChildProcess writer(const std::string& url, const std::string& server, int count) {
    return ChildProcess::start({METIER_RECORDS_WRITER, url, server, std::to_string(count)}).value();
}

/// Times at which it showed each of its executions, up to `lines` of them.
std::map<std::string, UtcTime> shown(ChildProcess& writer, int lines) {
    std::map<std::string, UtcTime> times;
    while (static_cast<int>(times.size()) < lines) {
        const auto line = writer.readLine(soon() + 40s);
        if (!line) {
            break;
        }
        if (*line == "ready") {
            continue;
        }
        const auto space = line->find(' ');
        times[line->substr(0, space)] =
            UtcTime(std::chrono::microseconds(std::stoll(line->substr(space + 1))));
    }
    return times;
}

/// Number of executions in a store, up to 200.
std::size_t countIn(const std::string& file) {
    return Store::open(file).value()->list({}, {.before = 0, .count = 200})->executions.size();
}

// It wakes up to gather, to write and to sync: on a machine that is busy, each may be late.
TEST(KilledServer, LosesAtMostTheLastSecondOfItsRecords) {
    const auto folder = testFolder();
    const auto file = (folder / "records.db").string();
    const Lateness lateness(folder);
    auto dying = writer(file, "dying", 0);
    auto times = shown(dying, 400);  // two seconds
    for (const auto end = soon(); countIn(file) <= 100 && std::chrono::steady_clock::now() < end;) {
        times.merge(shown(dying, 40));  // its disk is slow
    }
    dying.signal(SIGKILL);
    const auto killed = std::chrono::system_clock::now();
    ASSERT_EQ(dying.waitUntil(soon()), 128 + SIGKILL);
    times.merge(shown(dying, 1'000'000));  // lines that were still on their way
    const auto bound = 1s + 3 * lateness.worst();
    const auto store = Store::open(file).value();
    std::size_t kept = 0;
    for (const auto& [id, time] : times) {
        const auto found = store->find(id);
        kept += found ? 1 : 0;
        if (time < killed - bound) {
            ASSERT_TRUE(found) << id << " began "
                               << std::chrono::duration<double>(killed - time).count()
                               << " s before the kill";
            EXPECT_EQ(found->state, "Ready");
            EXPECT_EQ(store->path(found->number)->size(), 1U);
        }
    }
    EXPECT_GT(kept, 100U) << "of " << times.size();
    RecordProperty("shown", static_cast<int>(times.size()));
    RecordProperty("kept", static_cast<int>(kept));
}

void expectNothingLostOfTwo(const std::string& url) {
    constexpr int kEach = 2'000;
    auto one = writer(url, "one", kEach);
    auto two = writer(url, "two", kEach);
    EXPECT_EQ(shown(one, kEach).size(), kEach + 0U);
    EXPECT_EQ(shown(two, kEach).size(), kEach + 0U);
    ASSERT_EQ(one.waitUntil(soon()), 0);
    ASSERT_EQ(two.waitUntil(soon()), 0);
    const auto store = Store::open(url).value();
    for (const auto* server : {"one", "two"}) {
        Filter filter;
        filter.server = server;
        const auto listed = store->list(filter, {.before = 0, .count = 10'000})->executions;
        EXPECT_EQ(listed.size(), kEach + 0U);
        std::set<std::string> ids;
        for (const auto& execution : listed) {
            ids.insert(execution.id);
        }
        EXPECT_EQ(ids.size(), kEach + 0U);
        const auto path = store->path(store->find(std::string(server) + "-7")->number).value();
        ASSERT_EQ(path.size(), 1U);
        EXPECT_EQ(path[0].actual[0], 7.0);
    }
}

TEST(TwoServers, WriteIntoOneFileAtTheSameTime) {
    expectNothingLostOfTwo((testFolder() / "records.db").string());
}

TEST(TwoServers, WriteIntoOneDatabaseAtTheSameTime) {
    const auto url = postgresOrNothing();
    if (url.empty()) {
        GTEST_SKIP() << "PostgreSQL is not installed";
    }
    expectNothingLostOfTwo(url);
}

std::string stateOf(const std::string& url, const std::string& id) {
    return Store::open(url).value()->find(id).value().state;
}

/// Servers that died and servers that live, in a store of either kind.
void expectTheDeadClosedAlone(const std::string& url) {
    for (const auto* server : {"one", "two"}) {
        auto dead = writer(url, server, 3);
        ASSERT_EQ(dead.waitUntil(soon()), 0);
    }
    const auto living = recorderOf(url, "three");
    living->begin(moveOf("three-1"));
    ASSERT_TRUE(living->flush(soon()));
    const auto again = recorderOf(url, "one");
    ASSERT_TRUE(again->flush(soon()));
    EXPECT_EQ(stateOf(url, "one-3"), kLost);
    EXPECT_EQ(stateOf(url, "two-3"), kLost) << "it may never be started again";
    EXPECT_EQ(stateOf(url, "three-1"), "Running");
    Filter lost;
    lost.state = kLost;
    EXPECT_EQ(Store::open(url).value()->list(lost, {})->executions.size(), 2U);
}

TEST(StartedAgain, ClosesWhatAllDeadServersLeft) {
    expectTheDeadClosedAlone((testFolder() / "records.db").string());
}

TEST(StartedAgain, ClosesWhatAllDeadServersLeftInOneDatabase) {
    const auto url = postgresOrNothing();
    if (url.empty()) {
        GTEST_SKIP() << "PostgreSQL is not installed";
    }
    expectTheDeadClosedAlone(url);
}

void expectTheLivingLeftAlone(const std::string& url) {
    const auto first = recorderOf(url, "one");
    const auto key = first->begin(moveOf("one-1"));
    ASSERT_TRUE(first->flush(soon()));
    {
        const auto second = recorderOf(url, "one");
        second->begin(moveOf("one-2"));
        ASSERT_TRUE(second->flush(soon()));
        EXPECT_EQ(stateOf(url, "one-1"), "Running");
    }
    first->end(key, finished(at(1)));
    ASSERT_TRUE(first->flush(soon()));
    EXPECT_EQ(stateOf(url, "one-1"), "Ready");
}

TEST(TwoServersOfOneName, LeaveEachOthersAlone) {
    expectTheLivingLeftAlone((testFolder() / "records.db").string());
}

TEST(TwoServersOfOneName, LeaveEachOthersAloneInOneDatabase) {
    const auto url = postgresOrNothing();
    if (url.empty()) {
        GTEST_SKIP() << "PostgreSQL is not installed";
    }
    expectTheLivingLeftAlone(url);
}

/// Whether anybody has a lock on the file, which would be there as long as it is open.
bool isLocked(int file) {
    struct flock all {};
    all.l_type = F_WRLCK;
    return ::fcntl(file, F_OFD_GETLK, &all) == 0 && all.l_type != F_UNLCK;
}

// Without its lock another process that closes the file takes it for the last and removes the log.
TEST(TwoServersOfOneProcess, KeepTheLocksOfTheirFile) {
    const auto file = (testFolder() / "records.db").string();
    const auto first = recorderOf(file, "one");
    ASSERT_TRUE(first->flush(soon()));
    const int looking = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_TRUE(isLocked(looking));
    const auto second = recorderOf(file, "two");
    ASSERT_TRUE(second->flush(soon()));
    EXPECT_TRUE(isLocked(looking));
    ::close(looking);
}

TEST(SocketDeadlineTest, EndsACallThatWouldWaitForEver) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
    SocketDeadline deadline;
    char byte = 0;
    {
        const auto armed = deadline.arm(ends[0], 30s);
        ASSERT_EQ(::write(ends[1], "x", 1), 1);
        EXPECT_EQ(::read(ends[0], &byte, 1), 1);
    }
    const auto armed = deadline.arm(ends[0], 10ms);
    EXPECT_EQ(::read(ends[0], &byte, 1), 0);  // returns
    ::close(ends[0]);
    ::close(ends[1]);
}

}  // namespace
}  // namespace metier::records
