// A server whose disk hangs, or is full: no execution starts without a record, and no call waits.
#include <gmock/gmock.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "program_bench.hpp"

namespace metier::skill::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Disk of the test: it hangs, refuses and takes as it is asked to.
class TestDisk {
public:
    void hang() {
        const std::lock_guard lock(mutex_);
        hangs_ = true;
    }
    void letGo() {
        {
            const std::lock_guard lock(mutex_);
            hangs_ = false;
        }
        changed_.notify_all();
    }
    void refuse(std::string why) {
        const std::lock_guard lock(mutex_);
        refusal_ = std::move(why);
    }
    Result<void> write(const std::string& line) {
        std::unique_lock lock(mutex_);
        ++begun_;
        changed_.notify_all();
        changed_.wait(lock, [this] { return !hangs_; });
        if (!refusal_.empty()) {
            return metier::fail(Errc::resource_unavailable, refusal_);
        }
        lines_.push_back(line);
        return {};
    }
    /// Waits until that many writes have begun; false after 10 s.
    bool awaitWrites(int count) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, 10s, [&] { return begun_ >= count; });
    }
    std::vector<std::string> lines() {
        const std::lock_guard lock(mutex_);
        return lines_;
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    bool hangs_ = false;
    std::string refusal_;
    std::vector<std::string> lines_;
    int begun_ = 0;
};

class FileOnTestDisk final : public NameFile {
public:
    explicit FileOnTestDisk(TestDisk& disk) : disk_(disk) {}
    Result<void> append(const std::string& line) override { return disk_.write(line); }
    Result<void> beginAnew() override { return {}; }

private:
    TestDisk& disk_;
};

/// A Program whose names go to a disk that hangs.
class HangingDisk : public ::testing::Test {
protected:
    HangingDisk() { disk_.hang(); }
    ~HangingDisk() override { disk_.letGo(); }
    HangingDisk(const HangingDisk&) = delete;
    HangingDisk& operator=(const HangingDisk&) = delete;

    std::shared_ptr<ExecutionNames> namesOn(std::chrono::milliseconds longest_write) {
        return std::make_shared<ExecutionNames>(
            std::make_unique<FileOnTestDisk>(disk_),
            ExecutionNames::Options{.longest_write = longest_write});
    }
    Result<std::string> start(const std::string& name) {
        return bench_.program->startWith(kAlice, {.execution_id = name});
    }
    /// Lets the disk continue, and runs the Program's notification.
    void letGo() {
        const auto posts = bench_.executor->posts();
        disk_.letGo();
        ASSERT_TRUE(bench_.executor->awaitPosts(posts + 1));
        bench_.run();
    }
    const std::vector<std::string>& calls() const { return bench_.script->calls; }

    TestDisk disk_;
    ProgramBench bench_{{.names = namesOn(10min)}};
};

TEST_F(HangingDisk, StartsTheWorkOnceTheNameIsOnDisk) {
    ASSERT_EQ(start("weld 1"), "weld 1");
    bench_.run();
    EXPECT_EQ(bench_.program->state(), State::running);
    EXPECT_THAT(calls(), IsEmpty());
    letGo();
    EXPECT_THAT(disk_.lines(), ElementsAre("WeldSkill\tweld 1\n"));
    EXPECT_THAT(calls(), ElementsAre("start"));
}

TEST_F(HangingDisk, LetsAHaltThroughAndStartsNothingAfterwards) {
    ASSERT_TRUE(start("weld 1"));
    ASSERT_TRUE(disk_.awaitWrites(1));
    EXPECT_TRUE(bench_.call(Method::halt));
    EXPECT_EQ(bench_.program->state(), State::halted);
    EXPECT_EQ(bench_.program->reason(), Reason::by_client);
    disk_.letGo();
    bench_.run();
    EXPECT_THAT(calls(), ElementsAre("destroyed"));
}

TEST_F(HangingDisk, GivesTheExecutionUpInTime) {
    ASSERT_TRUE(start("weld 1"));
    bench_.executor->advance(999ms);
    EXPECT_EQ(bench_.program->state(), State::running);
    bench_.executor->advance(1ms);
    EXPECT_EQ(bench_.program->state(), State::halted);
    EXPECT_EQ(bench_.program->reason(), Reason::error);
    EXPECT_THAT(bench_.program->reasonText(), HasSubstr("not on disk after 1000 ms"));
    EXPECT_EQ(start("weld 1"), "weld 1") << "the name is used";
    EXPECT_EQ(bench_.program->execution("weld 1")->state, State::halted);
    EXPECT_THAT(calls(), Not(Contains("start")));
}

TEST_F(HangingDisk, MaySuspendWhatHasNotBegun) {
    ASSERT_TRUE(start("weld 1"));
    EXPECT_TRUE(bench_.call(Method::suspend));
    EXPECT_EQ(bench_.program->state(), State::suspended);
    letGo();
    EXPECT_THAT(calls(), IsEmpty());
    EXPECT_TRUE(bench_.call(Method::resume));
    EXPECT_EQ(bench_.program->state(), State::running);
    EXPECT_THAT(calls(), ElementsAre("start"));
}

TEST_F(HangingDisk, MayGiveUpWhatWasSuspendedBeforeItBegan) {
    ASSERT_TRUE(start("weld 1"));
    EXPECT_TRUE(bench_.call(Method::suspend));
    EXPECT_TRUE(bench_.call(Method::resume));
    EXPECT_THAT(calls(), IsEmpty()) << "it is still not on disk";
    EXPECT_TRUE(bench_.call(Method::suspend));
    EXPECT_TRUE(bench_.call(Method::reset));
    EXPECT_EQ(bench_.program->state(), State::ready);
    EXPECT_THAT(calls(), ElementsAre("destroyed"));
}

TEST_F(HangingDisk, StopsNoDeviceForWhatHasNotBegun) {
    ASSERT_TRUE(start("weld 1"));
    bench_.program->deviceLost("unplugged");
    EXPECT_EQ(bench_.program->state(), State::halted);
    EXPECT_THAT(calls(), ElementsAre("destroyed"));
}

TEST_F(HangingDisk, TakesNoLiveValueBeforeTheWorkHasBegun) {
    ASSERT_TRUE(start("weld 1"));
    EXPECT_EQ(bench_.program->write(kAlice, "Offset", 0.05).error().code, Errc::invalid_state);
    letGo();
    EXPECT_TRUE(bench_.program->write(kAlice, "Offset", 0.05));
}

TEST_F(HangingDisk, LeavesADeviceAloneWhoseWorkHasNotBegunWhenItsProgramEnds) {
    const auto names = namesOn(250ms);
    ProgramBench bench({.names = names});
    ASSERT_TRUE(bench.program->startWith(kAlice, {.execution_id = "weld 1"}));
    bench.program.reset();
    EXPECT_THAT(bench.script->calls, ElementsAre("destroyed"));
    disk_.letGo();  // before the names go
}

TEST_F(HangingDisk, HasNoDeadlineLeftOnceTheWorkHasBegunOrWasGivenUp) {
    ASSERT_TRUE(start("weld 1"));
    EXPECT_EQ(bench_.executor->timerCount(), 1U);
    letGo();
    EXPECT_EQ(bench_.executor->timerCount(), 0U);
    disk_.hang();
    bench_.script->execution.finish();
    bench_.run();
    ASSERT_TRUE(start("weld 2"));
    ASSERT_TRUE(bench_.call(Method::halt));
    EXPECT_EQ(bench_.executor->timerCount(), 0U);
}

TEST_F(HangingDisk, BeginsTheWorkOnceAlsoIfItIsSuspendedBeforeAndAfter) {
    ASSERT_TRUE(start("weld 1"));
    ASSERT_TRUE(bench_.call(Method::suspend));
    ASSERT_TRUE(bench_.call(Method::resume));
    letGo();
    EXPECT_THAT(calls(), ElementsAre("start"));
    ASSERT_TRUE(bench_.call(Method::suspend));
    bench_.script->execution.atRest();
    bench_.run();
    ASSERT_TRUE(bench_.call(Method::resume));
    EXPECT_THAT(calls(), ElementsAre("start", "suspend", "resume"));
}

TEST_F(HangingDisk, TakesNamesAgainOnceItGoesOn) {
    ProgramBench bench({.names = namesOn(0ms)});
    ASSERT_TRUE(bench.program->startWith(kAlice, {.execution_id = "weld 1"}));
    disk_.letGo();
    ASSERT_TRUE(bench.executor->awaitPosts(1));
    bench.run();
    bench.script->execution.finish();
    bench.run();
    EXPECT_TRUE(bench.program->startWith(kAlice, {.execution_id = "weld 2"}));
}

TEST_F(HangingDisk, RefusesFurtherNamesButNotAStartWithoutOne) {
    ProgramBench bench({.names = namesOn(0ms)});
    ASSERT_TRUE(bench.program->startWith(kAlice, {.execution_id = "weld 1"}));
    ASSERT_TRUE(disk_.awaitWrites(1));
    ASSERT_TRUE(bench.call(Method::halt));
    ASSERT_TRUE(bench.call(Method::reset));
    const auto refused = bench.program->startWith(kAlice, {.execution_id = "weld 2"});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::resource_unavailable);
    EXPECT_THAT(refused.error().message, HasSubstr("the disk has not taken"));
    EXPECT_EQ(bench.program->state(), State::ready);
    EXPECT_TRUE(bench.program->startWith(kAlice, {})) << "nobody asks whether it has begun";
    disk_.letGo();  // before the names go
}

TEST(FullDisk, HaltsWhatItDoesNotTakeBeforeAnythingMoves) {
    TestDisk disk;
    disk.refuse("no space left");
    ProgramBench bench({.names = std::make_shared<ExecutionNames>(
                            std::make_unique<FileOnTestDisk>(disk), ExecutionNames::Options{})});
    ASSERT_TRUE(bench.program->startWith(kAlice, {.execution_id = "weld 1"}));
    ASSERT_TRUE(bench.executor->awaitPosts(1));
    bench.run();
    EXPECT_EQ(bench.program->state(), State::halted);
    EXPECT_EQ(bench.program->reason(), Reason::error);
    EXPECT_EQ(bench.program->reasonText(), "no space left; nothing has moved");
    EXPECT_THAT(bench.script->calls, ElementsAre("destroyed"));
    disk.refuse({});
    ASSERT_TRUE(bench.call(Method::reset));
    ASSERT_TRUE(bench.program->startWith(kAlice, {.execution_id = "weld 2"}));
    ASSERT_TRUE(bench.executor->awaitPosts(2));
    bench.run();
    EXPECT_THAT(bench.script->calls, Contains("start"));
    EXPECT_THAT(disk.lines(), ElementsAre("WeldSkill\tweld 2\n"));
}

}  // namespace
}  // namespace metier::skill::testing
