// Composed skills over real Programs, one composed skill within another.
#include "metier/composition/local_used_skill.hpp"

#include <gmock/gmock.h>

#include "bench.hpp"
#include "metier/skill/lambda_skill.hpp"

namespace metier::composition {
namespace {

using skill::Program;
using skill::State;
using skill::ValueMap;
using ::testing::HasSubstr;
using testing::kClient;

/// Programs of one thread; the test is the device.
class LocalUsedSkills : public ::testing::Test {
protected:
    Program& addMove() {
        skill::SkillFunctions functions;
        functions.start = [this](const ValueMap& parameters,
                                 const skill::ExecutionHandle& execution) {
            snapshot_ = parameters;
            execution_ = execution;
        };
        functions.suspend = [](const skill::ExecutionHandle& execution) -> Result<void> {
            execution.atRest();
            return {};
        };
        functions.resume = [](const skill::ExecutionHandle&) -> Result<void> { return {}; };
        functions.halt = [](const skill::ExecutionHandle& execution) { execution.atRest(); };
        return add(
            std::make_unique<skill::LambdaSkill>(testing::moveDescription(), std::move(functions)));
    }

    /// A composed skill of that name with one step, which runs `inner`.
    Program& addAround(const std::string& name, Program& inner) {
        const auto text = "name = \"" + name +
                          "\"\n[parameters.Target]\ntype = \"number\"\nunit = "
                          "\"m\"\ndefault = 1\n[results.Reached]\ntype = \"number\"\nunit = "
                          "\"m\"\nfrom = \"go.Reached\"\n[uses.inner]\ntype = \"" +
                          inner.description().type +
                          "\"\n[[step]]\nname = \"go\"\nrun = \"inner\"\nwith.Target = { from = "
                          "\"Target\" }\n";
        auto composition =
            compose(parseDefinition(text, name + ".toml").value(), {{"inner", inner.description()}})
                .value();
        std::map<std::string, std::unique_ptr<UsedSkill>> used_skills;
        used_skills.emplace("inner", std::make_unique<LocalUsedSkill>(
                                         inner, executor_, skill::Caller{name, name, ""}));
        return add(std::make_unique<SequenceSkill>(
            std::move(composition), std::move(used_skills),
            SequenceSkill::Host{executor_, executor_->clock(), "here." + name}));
    }

    Program& add(std::unique_ptr<skill::Skill> skill) {
        programs_.push_back(std::make_unique<Program>(skill::ProgramOptions{}, std::move(skill),
                                                      executor_, executor_->clock()));
        return *programs_.back();
    }

    ~LocalUsedSkills() override {
        while (!programs_.empty()) {
            programs_.pop_back();  // the outer ones first
        }
    }

    std::shared_ptr<skill::testing::ManualExecutor> executor_ =
        std::make_shared<skill::testing::ManualExecutor>();
    std::vector<std::unique_ptr<Program>> programs_;
    ValueMap snapshot_;
    skill::ExecutionHandle execution_;
};

TEST_F(LocalUsedSkills, StackThreeDeep) {
    auto& move = addMove();
    auto& inner = addAround("Inner", move);
    auto& middle = addAround("Middle", inner);
    auto& outer = addAround("Outer", middle);
    ASSERT_TRUE(outer.startWith(kClient, {"top", {{"Target", 4.0}}}));
    executor_->run();
    for (const auto* program : {&outer, &middle, &inner, &move}) {
        EXPECT_EQ(program->state(), State::running);
    }
    EXPECT_EQ(snapshot_.at("Target"), skill::Value(4.0));
    EXPECT_EQ(execution_.id(), "here.Inner/here.Middle/here.Outer/top/go/1/go/1/go/1");
    execution_.finish({{"Reached", 3.9}});
    executor_->run();
    for (const auto* program : {&outer, &middle, &inner, &move}) {
        EXPECT_EQ(program->state(), State::ready);
    }
    EXPECT_EQ(outer.finalResult(), (ValueMap{{"Reached", 3.9}}));
}

TEST_F(LocalUsedSkills, AreSuspendedResumedAndHaltedThroughAllLevels) {
    auto& move = addMove();
    auto& inner = addAround("Inner", move);
    auto& outer = addAround("Outer", inner);
    ASSERT_TRUE(outer.start(kClient));
    executor_->run();
    ASSERT_TRUE(outer.suspend(kClient));
    executor_->run();
    for (const auto* program : {&outer, &inner, &move}) {
        EXPECT_EQ(program->state(), State::suspended);
    }
    ASSERT_TRUE(outer.resume(kClient));
    executor_->run();
    for (const auto* program : {&outer, &inner, &move}) {
        EXPECT_EQ(program->state(), State::running);
    }
    ASSERT_TRUE(outer.halt(kClient));
    executor_->run();
    for (const auto* program : {&outer, &inner, &move}) {
        EXPECT_EQ(program->state(), State::halted);
    }
    ASSERT_TRUE(outer.reset(kClient));
    executor_->run();
    for (const auto* program : {&outer, &inner, &move}) {
        EXPECT_EQ(program->state(), State::ready) << "what it halted itself, it resets";
    }
}

TEST_F(LocalUsedSkills, TellTheFailureOfTheInnermostSkill) {
    auto& move = addMove();
    auto& outer = addAround("Outer", addAround("Inner", move));
    ASSERT_TRUE(outer.start(kClient));
    executor_->run();
    move.deviceLost("the cable is cut");
    executor_->run();
    EXPECT_EQ(outer.subState(), skill::SubState::halted_device_lost);
    EXPECT_EQ(outer.reasonText(),
              "step go: Inner was Halted (DeviceLost): step go: MoveSkill was Halted "
              "(DeviceLost): the cable is cut");
}

TEST_F(LocalUsedSkills, TellARefusedStart) {
    auto& outer = addAround("Outer", addMove());
    ASSERT_TRUE(outer.startWith(kClient, {"", {{"Target", 11.0}}}));
    executor_->run();
    EXPECT_EQ(outer.state(), State::halted);
    EXPECT_THAT(outer.reasonText(),
                HasSubstr("refused Start: Target: 11 m is over the limit 10 m"));
}

TEST_F(LocalUsedSkills, EndWithAFailureIfTheyAreResetWhileSuspended) {
    auto& move = addMove();
    auto& outer = addAround("Outer", move);
    ASSERT_TRUE(outer.start(kClient));
    executor_->run();
    ASSERT_TRUE(move.suspend(kClient));
    executor_->run();
    EXPECT_EQ(outer.state(), State::suspended);
    ASSERT_TRUE(move.reset(kClient));
    executor_->run();
    EXPECT_EQ(outer.state(), State::halted);
    EXPECT_THAT(outer.reasonText(), HasSubstr("it was reset while it was suspended"));
}

TEST_F(LocalUsedSkills, TellTheirProgress) {
    auto& outer = addAround("Outer", addMove());
    skill::testing::RecordingObserver observer;
    outer.attach(observer);
    ASSERT_TRUE(outer.start(kClient));
    executor_->run();
    execution_.progress(0.25);
    executor_->run();
    EXPECT_THAT(observer.log, ::testing::Contains("progress 0.25"));
    outer.detach(observer);
}

/// Keeps the reports of a UsedSkill.
class Listener final : public UsedSkillListener {
public:
    void onReset(const Result<void>& outcome) override {
        told.emplace_back(outcome ? "reset" : "not reset");
    }
    void onStopping(const UsedSkillStop& stop) override {
        told.push_back("stopping, then " + std::string(toString(stop.to)) + ": " + stop.text);
    }
    void onSuspended() override { told.emplace_back("suspended"); }
    void onResumed() override { told.emplace_back("resumed"); }
    void onProgress(const skill::Value& intermediate) override {
        told.push_back("progress " + skill::toString(intermediate));
    }
    void onRefused(skill::Method method, const Error& error) override {
        told.push_back(std::string(toString(method)) + " refused: " + error.message);
    }
    void onEnd(UsedSkillEnd end) override {
        ends.push_back(std::move(end));
        told.emplace_back("end");
    }

    std::vector<std::string> told;
    std::vector<UsedSkillEnd> ends;
};

class OneLocalUsedSkill : public LocalUsedSkills {
protected:
    /// Reports since the last call.
    std::vector<std::string> told() {
        executor_->run();
        return std::exchange(listener_.told, {});
    }

    Listener listener_;
    Program& move_ = addMove();
    LocalUsedSkill used_{move_, executor_, kClient};
};

TEST_F(OneLocalUsedSkill, TellsItsWholeLife) {
    used_.begin({.execution_id = "one"}, listener_);
    EXPECT_THAT(told(), ::testing::IsEmpty());
    execution_.progress(0.5);
    ASSERT_TRUE(used_.suspend());
    EXPECT_THAT(told(), ::testing::ElementsAre("stopping, then Suspended: by client",
                                               "progress 0.5", "suspended"));
    ASSERT_TRUE(used_.resume());
    EXPECT_THAT(told(), ::testing::ElementsAre("resumed"));
    execution_.finish({{"Reached", 1.5}});
    EXPECT_THAT(told(), ::testing::ElementsAre("end"));
    EXPECT_EQ(listener_.ends[0].kind, UsedSkillEnd::Kind::finished);
    EXPECT_EQ(listener_.ends[0].result.at("Reached"), skill::Value(1.5));
}

TEST_F(OneLocalUsedSkill, IsHaltedWithItsReason) {
    used_.begin({.execution_id = "one"}, listener_);
    executor_->run();
    execution_.fail(skill::Reason::limit_violated, "too fast");
    EXPECT_THAT(told(), ::testing::ElementsAre("end"));
    EXPECT_EQ(listener_.ends[0].kind, UsedSkillEnd::Kind::halted);
    EXPECT_EQ(listener_.ends[0].reason, skill::Reason::limit_violated);
    EXPECT_EQ(listener_.ends[0].text, "too fast");
}

TEST_F(OneLocalUsedSkill, TellsOfARefusedHalt) {
    ASSERT_TRUE(move_.halt(kClient));
    used_.begin({.execution_id = "one"}, listener_);
    EXPECT_THAT(told(), ::testing::ElementsAre("end"));
    EXPECT_EQ(listener_.ends[0].kind, UsedSkillEnd::Kind::refused);
    used_.halt();
    const auto refused = told();
    ASSERT_EQ(refused.size(), 1U);
    EXPECT_THAT(refused[0], HasSubstr("Halt refused: Halt is not possible while Halted"));
}

TEST_F(OneLocalUsedSkill, TellsNothingOfOthersExecutions) {
    ASSERT_TRUE(move_.startWith(kClient, {"foreign", {}}));
    execution_.progress(0.5);
    executor_->run();
    ASSERT_TRUE(move_.suspend(kClient));
    executor_->run();
    ASSERT_TRUE(move_.reset(kClient));
    used_.begin({.execution_id = "one"}, listener_);
    executor_->run();
    execution_.finish();
    EXPECT_THAT(told(), ::testing::ElementsAre("end"));
    ASSERT_TRUE(move_.startWith(kClient, {"foreign 2", {}}));
    execution_.progress(0.5);
    executor_->run();
    ASSERT_TRUE(move_.halt(kClient));
    EXPECT_THAT(told(), ::testing::IsEmpty());
}

TEST_F(OneLocalUsedSkill, TellsNothingOnceItsListenerHasLetGo) {
    used_.begin({.execution_id = "one"}, listener_);
    executor_->run();
    execution_.progress(0.5);
    executor_->run();
    listener_.told.clear();
    ASSERT_TRUE(used_.suspend());
    used_.release();
    EXPECT_THAT(told(), ::testing::IsEmpty());
}

TEST_F(OneLocalUsedSkill, IsResetAndTellsItLaterOrRefusesAtOnce) {
    EXPECT_FALSE(used_.reset(listener_)) << "it is Ready";
    EXPECT_THAT(told(), ::testing::IsEmpty());
    ASSERT_TRUE(move_.halt(kClient));
    ASSERT_TRUE(used_.reset(listener_));
    EXPECT_THAT(listener_.told, ::testing::IsEmpty()) << "not from inside the call";
    EXPECT_THAT(told(), ::testing::ElementsAre("reset"));
}

TEST_F(OneLocalUsedSkill, AnswersChecksAndClocksLaterAndNotOnceItIsGone) {
    std::vector<bool> possible;
    std::vector<ClockOffset> offsets;
    const auto checked = [&](const Result<skill::CheckReport>& report) {
        possible.push_back(report->possible);
    };
    const auto compared = [&](const Result<ClockOffset>& offset) { offsets.push_back(*offset); };
    used_.check({.parameters = {{"Target", 1.0}}}, checked);
    used_.check({.parameters = {{"Target", 11.0}}}, checked);
    used_.compareClocks(compared);
    EXPECT_TRUE(possible.empty() && offsets.empty()) << "in a later turn";
    executor_->run();
    EXPECT_THAT(possible, ::testing::ElementsAre(true, false));
    ASSERT_EQ(offsets.size(), 1U);
    EXPECT_EQ(offsets[0].ahead.count(), 0) << "it is the same clock";
    EXPECT_EQ(offsets[0].uncertainty.count(), 0);
    {
        LocalUsedSkill gone(move_, executor_, kClient);
        gone.check({}, checked);
        gone.compareClocks(compared);
    }
    executor_->run();
    EXPECT_EQ(possible.size(), 2U);
    EXPECT_EQ(offsets.size(), 1U);
}

TEST_F(OneLocalUsedSkill, HearsNoMoreOfItsProgramOnceItIsGone) {
    {
        LocalUsedSkill gone(move_, executor_, kClient);
        gone.begin({.execution_id = "one"}, listener_);
        executor_->run();
        execution_.progress(0.5);
    }
    execution_.finish();
    EXPECT_THAT(told(), ::testing::IsEmpty());
    EXPECT_EQ(move_.state(), State::ready);
}

}  // namespace
}  // namespace metier::composition
