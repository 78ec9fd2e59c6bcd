#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "metier/skill/lambda_skill.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/testing/manual_executor.hpp"
#include "metier/skill/testing/recording_observer.hpp"
#include "metier/skill/typed_skill.hpp"

namespace metier::skill::testing {
namespace {

using ::testing::ElementsAre;

const Caller kClient{"session", "client", "user"};

/// A Program of the skill under test.
struct Bench {
    explicit Bench(std::unique_ptr<Skill> skill)
        : program({}, std::move(skill), executor, executor->clock()) {
        program.attach(observer);
    }

    std::shared_ptr<ManualExecutor> executor = std::make_shared<ManualExecutor>();
    RecordingObserver observer;
    Program program;
};

std::unique_ptr<Skill> lambdaSkill(SkillFunctions functions) {
    return std::make_unique<LambdaSkill>(
        SkillDescription{
            .name = "BlinkSkill",
            .parameters = {{.name = "Times", .type = ValueType::int32, .default_value = 3}},
            .results = {{.name = "Blinked", .type = ValueType::int32}}},
        std::move(functions));
}

TEST(LambdaSkill, WithoutFunctionsFinishesAtOnceAndCannotBeSuspended) {
    Bench bench(lambdaSkill({}));
    EXPECT_FALSE(bench.program.description().suspendable);
    ASSERT_TRUE(bench.program.start(kClient));
    bench.executor->run();
    EXPECT_EQ(bench.program.state(), State::ready);
    ASSERT_TRUE(bench.program.halt(kClient));
    EXPECT_TRUE(bench.program.reset(kClient));
}

TEST(LambdaSkill, PassesParametersAndResult) {
    Bench bench(
        lambdaSkill({.start = [](const ValueMap& parameters, const ExecutionHandle& execution) {
            execution.finish({{"Blinked", parameters.at("Times")}});
        }}));
    ASSERT_TRUE(bench.program.write(kClient, "Times", 7));
    ASSERT_TRUE(bench.program.start(kClient));
    bench.executor->run();
    EXPECT_EQ(bench.program.finalResult().at("Blinked"), Value(7));
}

TEST(LambdaSkill, IsRefusedByItsCheck) {
    Bench bench(lambdaSkill({.check = [](const ValueMap&) -> Result<void> {
        return metier::fail(Errc::unreachable, "too dark");
    }}));
    EXPECT_EQ(bench.program.start(kClient).error().message, "too dark");
}

TEST(LambdaSkill, WithoutHaltIsAtRestWheneverItIsAsked) {
    Bench bench(lambdaSkill({.start = [](const ValueMap&, const ExecutionHandle&) {}}));
    ASSERT_TRUE(bench.program.start(kClient));
    ASSERT_TRUE(bench.program.halt(kClient));
    bench.executor->run();
    EXPECT_EQ(bench.program.state(), State::halted);
}

TEST(LambdaSkill, IsAskedForEveryStepOfItsLife) {
    std::vector<std::string> calls;
    Bench bench(lambdaSkill({
        .start = [&](const ValueMap&, const ExecutionHandle&) { calls.emplace_back("start"); },
        .suspend = [&](const ExecutionHandle& execution) -> Result<void> {
            calls.emplace_back("suspend");
            execution.atRest();
            return {};
        },
        .resume = [&](const ExecutionHandle&) -> Result<void> {
            calls.emplace_back("resume");
            return {};
        },
        .halt =
            [&](const ExecutionHandle& execution) {
                calls.emplace_back("halt");
                execution.atRest();
            },
        .force_stop = [&] { calls.emplace_back("force_stop"); },
        .reset = [&]() -> Result<void> {
            calls.emplace_back("reset");
            return {};
        },
    }));
    ASSERT_TRUE(bench.program.start(kClient));
    ASSERT_TRUE(bench.program.suspend(kClient));
    bench.executor->run();
    ASSERT_TRUE(bench.program.resume(kClient));
    ASSERT_TRUE(bench.program.halt(kClient));
    bench.executor->run();
    ASSERT_TRUE(bench.program.reset(kClient));
    ASSERT_TRUE(bench.program.start(kClient));
    bench.program.deviceLost("gone");
    EXPECT_THAT(calls,
                ElementsAre("start", "suspend", "resume", "halt", "reset", "start", "force_stop"));
}

struct Drill {
    double depth = 0;
    std::optional<double> speed{};
};
struct Drilled {
    double depth = 0;
};

class DrillSkill final : public TypedSkill<Drill, Drilled> {
public:
    DrillSkill()
        : TypedSkill(
              {.name = "DrillSkill", .type = "DrillSkillType"},
              FieldList<Drill>()
                  .add(&Drill::depth, {.name = "Depth", .unit = kMetre, .range = Range{0, 0.1}})
                  .add(&Drill::speed, {.name = "Speed", .unit = kRadianPerSecond}),
              FieldList<Drilled>().add(&Drilled::depth, {.name = "Depth", .unit = kMetre})) {}

protected:
    Result<std::unique_ptr<ExecutionWork>> plan(const Drill& parameters) override {
        if (parameters.depth > 0.08 && !parameters.speed) {
            return metier::fail(Errc::out_of_range, "Depth over 0.08 m needs Speed");
        }
        return std::make_unique<DrillWork>(*this, parameters);
    }

private:
    class DrillWork final : public ExecutionWork {
    public:
        DrillWork(const DrillSkill& skill, const Drill& parameters)
            : skill_(skill), parameters_(parameters) {}
        void start(ExecutionHandle execution) override {
            execution.finish(skill_.results().write({.depth = parameters_.depth}));
        }
        Result<void> suspend() override { return {}; }
        Result<void> resume() override { return {}; }
        void halt() override {}
        void forceStop() noexcept override {}

    private:
        const DrillSkill& skill_;
        const Drill parameters_;
    };
};

TEST(TypedSkill, DescribesItselfByItsStructs) {
    const DrillSkill skill;
    ASSERT_EQ(skill.description().parameters.size(), 2U);
    EXPECT_EQ(skill.description().parameters[0].name, "Depth");
    ASSERT_EQ(skill.description().results.size(), 1U);
    EXPECT_EQ(skill.description().results[0].place, Place::final_result);
}

TEST(TypedSkill, PlansWithAStructAndAnswersWithAStruct) {
    Bench bench(std::make_unique<DrillSkill>());
    ASSERT_TRUE(bench.program.write(kClient, "Depth", 0.05));
    ASSERT_TRUE(bench.program.start(kClient));
    bench.executor->run();
    EXPECT_EQ(bench.program.finalResult().at("Depth"), Value(0.05));
}

TEST(TypedSkill, ChecksItsParametersAsAWholeAtStart) {
    Bench bench(std::make_unique<DrillSkill>());
    ASSERT_TRUE(bench.program.write(kClient, "Depth", 0.09));
    EXPECT_EQ(bench.program.start(kClient).error().message, "Depth over 0.08 m needs Speed");
    ASSERT_TRUE(bench.program.write(kClient, "Speed", 30.0));
    EXPECT_TRUE(bench.program.start(kClient));
}

TEST(TypedSkill, ChecksASnapshotThatDidNotComeThroughAProgram) {
    DrillSkill skill;
    EXPECT_EQ(skill.prepare({}).error().code, Errc::invalid_argument);
    EXPECT_EQ(skill.prepare({{"Depth", 0.2}}).error().code, Errc::out_of_range);
    EXPECT_TRUE(skill.prepare({{"Depth", 0.02}}));
}

TEST(ExecutionWork, TakesNoLiveInputUnlessItSaysSo) {
    DrillSkill skill;
    const auto work = skill.prepare({{"Depth", 0.02}});
    ASSERT_TRUE(work);
    EXPECT_EQ((*work)->input("Depth", {0.03}).error().code, Errc::not_supported);
}

TEST(LambdaSkill, CanBeSuspendedOnlyIfItCanBeResumed) {
    const auto suspend = [](const ExecutionHandle&) { return Result<void>(); };
    EXPECT_FALSE(lambdaSkill({.suspend = suspend})->description().suspendable);
    EXPECT_FALSE(lambdaSkill({.resume = suspend})->description().suspendable);
    EXPECT_TRUE(lambdaSkill({.suspend = suspend, .resume = suspend})->description().suspendable);
}

TEST(LambdaSkill, WithoutAStopOfTheDeviceIsHaltedByItsLossAllTheSame) {
    Bench bench(lambdaSkill({.start = [](const ValueMap&, const ExecutionHandle&) {}}));
    ASSERT_TRUE(bench.program.start(kClient));
    bench.program.deviceLost("gone");
    EXPECT_EQ(bench.program.state(), State::halted);
}

TEST(LambdaSkill, TellsWhyItsResetIsRefused) {
    Bench bench(lambdaSkill(
        {.reset = [] { return Result<void>(metier::fail(Errc::device_fault, "too hot")); }}));
    ASSERT_TRUE(bench.program.halt(kClient));
    EXPECT_EQ(bench.program.reset(kClient).error().message, "too hot");
}

}  // namespace
}  // namespace metier::skill::testing
