#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <stop_token>
#include <thread>
#include <vector>

#include "metier/base/queue.hpp"
#include "program_bench.hpp"

namespace metier::skill::testing {
namespace {

using namespace std::chrono_literals;

/// Work with a thread of its own, like a device's cycle thread, that reports what it is asked.
class ThreadedWork final : public ExecutionWork {
public:
    explicit ThreadedWork(std::thread::id owner) : owner_(owner) {}
    ~ThreadedWork() override {
        EXPECT_EQ(std::this_thread::get_id(), owner_);
        asked_.close();
    }
    ThreadedWork(const ThreadedWork&) = delete;
    ThreadedWork& operator=(const ThreadedWork&) = delete;

    void start(ExecutionHandle execution) override {
        worker_ =
            std::jthread([this, execution](const std::stop_token& stop) { work(stop, execution); });
    }
    Result<void> suspend() override { return ask(); }
    Result<void> resume() override { return {}; }
    void halt() override { static_cast<void>(ask()); }
    void forceStop() noexcept override {}

private:
    Result<void> ask() {
        asked_.tryPush(0);
        return {};
    }
    void work(const std::stop_token& stop, const ExecutionHandle& execution) {
        int cycle = 0;
        while (!stop.stop_requested()) {
            execution.progress(static_cast<double>(++cycle));
            if (asked_.popUntil(std::chrono::steady_clock::now() + 200us)) {
                execution.atRest();
                execution.atRest();
            }
            if (cycle == 3) {
                execution.finish();
            }
        }
    }

    const std::thread::id owner_;
    Queue<int> asked_{16};
    std::jthread worker_;
};

class ThreadedSkill final : public Skill {
public:
    const SkillDescription& description() const override { return description_; }
    Result<std::unique_ptr<ExecutionWork>> prepare(const ValueMap& /*snapshot*/) override {
        return std::make_unique<ThreadedWork>(std::this_thread::get_id());
    }

private:
    SkillDescription description_{.name = "ThreadedSkill"};
};

/// Whether each event begins where the one before ended.
bool areInOrder(const std::vector<TransitionEvent>& events) {
    auto from = State::ready;
    for (const auto& event : events) {
        if (event.from != from) {
            return false;
        }
        from = event.to;
    }
    return true;
}

TEST(Race, BetweenWorkersAndCommandsLosesAndReordersNoEvent) {
    const auto executor = std::make_shared<ManualExecutor>();
    Program program({}, std::make_unique<ThreadedSkill>(), executor, executor->clock());
    RecordingObserver observer;
    program.attach(observer);
    for (int round = 0; round < 150; ++round) {
        ASSERT_TRUE(program.start(kAlice));
        if (round % 3 == 1) {
            ASSERT_TRUE(program.suspend(kAlice));
            ASSERT_TRUE(
                executor->runUntil([&] { return program.subState() != SubState::stopping; }));
            static_cast<void>(program.resume(kAlice));
        } else if (round % 3 == 2) {
            ASSERT_TRUE(program.halt(kAlice));
        }
        ASSERT_TRUE(executor->runUntil([&] { return program.state() != State::running; }));
        static_cast<void>(program.reset(kAlice));
        ASSERT_EQ(program.state(), State::ready) << round;
    }
    EXPECT_TRUE(areInOrder(observer.events));
}

/// Makes every thread report an end; returns when all have.
void endFromManyThreads(const ExecutionHandle& execution) {
    const auto end = [&execution] {
        execution.step("race");
        execution.finish({{"Length", 1.0}});
        execution.fail(Reason::error, "too late");
    };
    const std::array threads{std::jthread(end), std::jthread(end), std::jthread(end),
                             std::jthread(end)};
}

TEST(Race, OfManyHandlesEndsTheExecutionOnce) {
    ProgramBench bench;
    for (int round = 0; round < 100; ++round) {
        ASSERT_TRUE(bench.program->start(kAlice));
        const auto execution = bench.script->execution;
        endFromManyThreads(execution);
        bench.run();
        static_cast<void>(bench.program->reset(kAlice));
    }
    EXPECT_EQ(bench.observer.events.size(), 200U);
    EXPECT_TRUE(areInOrder(bench.observer.events));
}

TEST(Race, BetweenALateWorkerAndTheEndOfTheProgramIsHarmless) {
    for (int round = 0; round < 50; ++round) {
        ProgramBench bench;
        bench.enter(State::running);
        std::atomic<bool> running{false};
        const std::jthread worker(
            [&running, execution = bench.script->execution](const std::stop_token& stop) {
                while (!stop.stop_requested()) {
                    execution.progress(1.0);
                    execution.atRest();
                    execution.finish();
                    running = true;
                    running.notify_one();
                }
            });
        running.wait(false);
        bench.program.reset();
        bench.run();
        bench.forget();
    }
}

}  // namespace
}  // namespace metier::skill::testing
