#include "metier/robot_skills/stall_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>
#include <optional>

#include "controller_planned_bench.hpp"

namespace metier::robot_skills {
namespace {

using namespace std::chrono_literals;
using skill::State;
using skill::SubState;
using ::testing::HasSubstr;

constexpr auto kLimit = 250ms;

/// The executor of a bench, which announces what the watchdog posts.
class AnnouncingExecutor : public skill::Executor {
public:
    AnnouncingExecutor(std::shared_ptr<skill::Executor> bench, std::function<void()> posted)
        : bench_(std::move(bench)), posted_(std::move(posted)) {}

    void post(std::function<void()> work) override {
        bench_->post(std::move(work));
        posted_();
    }
    skill::Timer after(std::chrono::nanoseconds delay, std::function<void()> work) override {
        return bench_->after(delay, std::move(work));
    }

private:
    std::shared_ptr<skill::Executor> bench_;
    std::function<void()> posted_;
};

/// Watches the arm of a bench. The owner's thread is the test: it stalls when the time moves on
/// without it. The watchdog's thread is a real one, which reads this clock.
class Watched {
public:
    explicit Watched(Bench& bench) : Watched(bench, [&bench] { bench.arm().stop(); }) {}
    Watched(Bench& bench, std::function<void()> stop) : bench_(bench) {
        clock_.advance(1s);
        watch_.emplace(
            StallWatch::Setup{.name = "ur5",
                              .limit = kLimit,
                              .stop = std::move(stop),
                              .log =
                                  [this](const std::string& told) {
                                      ++lines;
                                      line = told;
                                      noticed_ = true;
                                  }},
            std::make_shared<AnnouncingExecutor>(bench_.sharedExecutor(), [this] { posted(); }),
            programs(), clock_);
    }

    /// The watch lets go on the owner's thread.
    ~Watched() {
        watch_.reset();
        bench_.executor().run();
    }
    Watched(const Watched&) = delete;
    Watched& operator=(const Watched&) = delete;

    /// A move of axis 1 that takes some seconds, and so many cycles of it.
    void startMove(int cycles = 50) {
        auto target = bench_.commanded();
        target[0] += 1.0;
        const auto started = bench_.start(
            kJointPtp, {{"TargetJointPosition", std::vector<double>(target.begin(), target.end())},
                        {"SpeedOverride", 0.2}});
        ASSERT_TRUE(started) << started.error().message;
        steps(cycles);
        ASSERT_EQ(program().state(), State::running) << program().reasonText();
    }

    void steps(int count) {
        for (int i = 0; i < count; ++i) {
            clock_.advance(bench_.arm().info().cycle);
            bench_.step();
        }
    }

    /// The owner's thread does nothing for so long; whether the watchdog stopped the arm then.
    bool stall(std::chrono::nanoseconds time) {
        clock_.advance(time);
        return stopped_.get_future().wait_for(60s) == std::future_status::ready;
    }

    /// Moves the arm on without the owner's thread, until it rests.
    void armRests() {
        for (int i = 0; i < 1000 && !bench_.arm().state().standstill; ++i) {
            bench_.arm().step();
        }
        ASSERT_TRUE(bench_.arm().state().standstill);
    }

    skill::Program& program() { return bench_.program(kJointPtp); }

    std::atomic<int> lines = 0;
    std::string line;  // the last one; to be read after stall()

private:
    std::vector<skill::Program*> programs() {
        return {&bench_.program(kJointPtp), &bench_.program(kPositionStream)};
    }
    /// The last that the watchdog does in a stall: the arm is stopped and the stall logged by then.
    void posted() {
        if (noticed_.exchange(false)) {
            stopped_.set_value();
        }
    }

    Bench& bench_;
    ManualClock clock_;
    std::atomic<bool> noticed_ = false;
    std::promise<void> stopped_;
    std::optional<StallWatch> watch_;
};

TEST(StallWatch, StopsTheArmAndHaltsWhatRanNamingTheStall) {
    Bench bench;
    Watched watched(bench);
    watched.startMove();
    ASSERT_TRUE(watched.stall(1200ms));
    watched.armRests();
    EXPECT_EQ(watched.program().state(), State::running) << "nobody was there to change it";
    bench.step();
    EXPECT_EQ(watched.program().subState(), SubState::halted_error);
    EXPECT_THAT(watched.program().reasonText(), HasSubstr("ur5: the server's thread did not work"));
    EXPECT_THAT(watched.program().reasonText(), HasSubstr("limit 0.25 s"));
    EXPECT_EQ(watched.lines, 1);
    ASSERT_TRUE(watched.program().reset(bench.caller()));
    watched.startMove();
}

TEST(StallWatch, HaltsAMoveOfTheControllersOwnPlannerNamingTheStall) {
    ControllerPlannedBench planned;
    Watched watched(planned.bench);
    watched.startMove(500);
    ASSERT_TRUE(watched.stall(1200ms));
    watched.armRests();
    planned.bench.step();
    EXPECT_EQ(watched.program().subState(), SubState::halted_error);
    EXPECT_THAT(watched.program().reasonText(), HasSubstr("the server's thread did not work"));
}

TEST(StallWatch, HaltsAtStandstillIfTheArmStillBrakes) {
    Bench bench;
    Watched watched(bench);
    watched.startMove();
    ASSERT_TRUE(watched.stall(kLimit + 100ms));
    bench.step();
    EXPECT_EQ(watched.program().subState(), SubState::stopping);
    ASSERT_TRUE(bench.stepUntil(kJointPtp, State::halted));
    EXPECT_TRUE(bench.arm().state().standstill);
    EXPECT_THAT(watched.program().reasonText(), HasSubstr("the server's thread did not work"));
}

TEST(StallWatch, OfAServerWithoutADeviceSaysNotThatItStoppedOne) {
    Bench bench;
    Watched watched(bench, nullptr);
    watched.startMove();
    ASSERT_TRUE(watched.stall(1200ms));
    EXPECT_THAT(watched.line, HasSubstr("limit 0.25 s: what runs is halted once it works again"));
    ASSERT_TRUE(bench.stepUntil(kJointPtp, State::halted));
    EXPECT_THAT(watched.program().reasonText(),
                HasSubstr("limit 0.25 s: the skills that it uses are halted"));
}

TEST(StallWatch, LeavesAServerThatWorksAlone) {
    Bench bench;
    Watched watched(bench);
    watched.startMove();
    ASSERT_TRUE(bench.stepUntil([&] {
        watched.steps(1);
        return watched.program().state() != State::running;
    }));
    EXPECT_EQ(watched.program().state(), State::ready) << watched.program().reasonText();
    EXPECT_EQ(watched.lines, 0);
}

}  // namespace
}  // namespace metier::robot_skills
