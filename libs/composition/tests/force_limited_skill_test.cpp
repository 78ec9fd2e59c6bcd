#include "metier/composition/force_limited_skill.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "metier/skill/testing/manual_executor.hpp"
#include "scripted_used_skill.hpp"

namespace metier::composition {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;
using skill::Vector3;
using skill::testing::ManualExecutor;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ScriptedUsedSkill;

/// A force source whose every word is the test's.
class ScriptedForce final : public ForceSource {
public:
    const std::string& name() const override { return name_; }
    Result<MeasuredForce> newest() const override { return now; }
    void add(ForceListener& listener) override { listeners_.insert(&listener); }
    void remove(ForceListener& listener) override { listeners_.erase(&listener); }

    void measure(const MeasuredForce& measured) {
        now = measured;
        for (auto* listener : std::set(listeners_)) {
            listener->onForce(measured);
        }
    }
    void lose(const Error& why) {
        now = fail(why);
        for (auto* listener : std::set(listeners_)) {
            listener->onForceLost(why);
        }
    }
    bool heardBySomebody() const { return !listeners_.empty(); }

    Result<MeasuredForce> now = MeasuredForce{};

private:
    std::string name_ = "FlangeForce of press";
    std::set<ForceListener*> listeners_;
};

class Listener final : public UsedSkillListener {
public:
    void onReset(const Result<void>& outcome) override { resets.push_back(outcome.has_value()); }
    void onStopping(const UsedSkillStop& stop) override { stops.push_back(stop.to); }
    void onEnd(UsedSkillEnd end) override { ends.push_back(std::move(end)); }

    std::vector<bool> resets;
    std::vector<State> stops;
    std::vector<UsedSkillEnd> ends;
};

class ForceLimitedSkillTest : public ::testing::Test {
protected:
    ForceLimitedSkillTest() {
        auto line = std::make_unique<ScriptedUsedSkill>(
            "CartesianLinearMoveSkill of iiwa",
            skill::SkillDescription{
                .name = "CartesianLinearMoveSkill",
                .type = "CartesianLinearMoveSkillType",
                .parameters = {{.name = "TargetPosition", .type = skill::ValueType::frame}},
                .results = {{.name = "LargestPathDeviation", .type = skill::ValueType::number}}});
        line_ = line.get();
        skill_ = limitForce(std::move(line), force_, executor_, executor_->clock());
    }

    MeasuredForce force(Vector3 newtons) const {
        return {.force = newtons, .received = executor_->clock().now()};
    }
    /// Begins with a limit of 20 N along z.
    void begin(skill::ValueMap more = {}) {
        skill::StartRequest request;
        request.parameters = std::move(more);
        request.parameters.emplace("MaxForce", Vector3{0, 0, 20});
        request.parameters.emplace("TargetPosition", skill::Frame{});
        skill_->begin(std::move(request), listener_);
    }
    void turn() { executor_->advance(0ns); }
    const UsedSkillEnd& onlyEnd() {
        EXPECT_EQ(listener_.ends.size(), 1U);
        static const UsedSkillEnd kNone;
        return listener_.ends.empty() ? kNone : listener_.ends.back();
    }
    template <typename T>
    T result(const char* name) {
        const auto& results = onlyEnd().result;
        const auto found = results.find(name);
        const auto* value = found == results.end() ? nullptr : std::get_if<T>(&found->second);
        EXPECT_NE(value, nullptr) << name;
        return value == nullptr ? T{} : *value;
    }

    std::shared_ptr<ManualExecutor> executor_ = std::make_shared<ManualExecutor>();
    std::shared_ptr<ScriptedForce> force_ = std::make_shared<ScriptedForce>();
    Listener listener_;
    ScriptedUsedSkill* line_ = nullptr;  // owned by skill_
    std::unique_ptr<UsedSkill> skill_;
};

TEST_F(ForceLimitedSkillTest, HasItsOwnFieldsBesidesThoseOfTheMove) {
    const auto& description = skill_->description();
    EXPECT_EQ(description.type, "CartesianLinearMoveSkillType");
    EXPECT_NE(skill::findField(description.parameters, "TargetPosition"), nullptr);
    ASSERT_NE(skill::findField(description.parameters, "MaxForce"), nullptr);
    EXPECT_EQ(skill::findField(description.parameters, "MaxForce")->unit, skill::kNewton);
    const auto* of_move = skill::findField(description.results, "LargestPathDeviation");
    ASSERT_NE(of_move, nullptr);
    EXPECT_TRUE(of_move->optional) << "a halted move has no results";
    EXPECT_NE(skill::findField(description.results, "ContactForce"), nullptr);
}

TEST_F(ForceLimitedSkillTest, ReachesTheTargetWhereNoForceIsMet) {
    begin();
    EXPECT_THAT(line_->heard(), ElementsAre("begin"));
    EXPECT_FALSE(line_->request.parameters.contains("MaxForce"));
    EXPECT_TRUE(line_->request.parameters.contains("TargetPosition"));
    force_->measure(force({-30, 0, -19.9}));
    force_->measure(force({1, 0, 2}));
    line_->finish({{"LargestPathDeviation", 0.001}});
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::finished);
    EXPECT_EQ(result<double>("LargestPathDeviation"), 0.001);
    EXPECT_EQ(result<Vector3>("ForcesExceeded"), Vector3{});
    EXPECT_EQ(result<Vector3>("ContactForce"), (Vector3{1, 0, 2}));
    EXPECT_EQ(result<Vector3>("ForcesMax"), (Vector3{30, 0, 19.9}));
    EXPECT_FALSE(onlyEnd().result.contains("ReactionTime"));
    EXPECT_FALSE(force_->heardBySomebody());
}

TEST_F(ForceLimitedSkillTest, EndsAtAForceAndResetsTheMove) {
    begin();
    executor_->advance(1s);
    force_->measure(force({0, 0, -5}));
    executor_->advance(10ms);
    force_->measure(force({0, 0, -21}));
    EXPECT_THAT(line_->heard(), ElementsAre("begin", "halt"));
    executor_->advance(3ms);
    force_->measure(force({0, 0, -40}));
    line_->stops(State::halted);
    EXPECT_THAT(listener_.stops, IsEmpty()) << "for its user it does not halt, it ends";
    executor_->advance(50ms);
    line_->halted();
    EXPECT_THAT(line_->heard(), ElementsAre("reset"));
    EXPECT_THAT(listener_.ends, IsEmpty());
    line_->wasReset();
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::finished);
    EXPECT_EQ(result<Vector3>("ForcesExceeded"), (Vector3{0, 0, -21}));
    EXPECT_EQ(result<Vector3>("ForcesMax").z, 40) << "while it braked";
    EXPECT_DOUBLE_EQ(result<double>("ReactionTime"), 0.013);
    EXPECT_DOUBLE_EQ(result<double>("StoppingTime"), 0.063);
    EXPECT_FALSE(onlyEnd().result.contains("LargestPathDeviation"));
    EXPECT_FALSE(skill_->leftOver());
}

TEST_F(ForceLimitedSkillTest, MeasuresTheReactionByTheStandstillOfAServerThatReportsNoBraking) {
    begin();
    executor_->advance(10ms);
    force_->measure(force({0, 0, -21}));
    executor_->advance(40ms);
    line_->halted();
    line_->wasReset();
    EXPECT_DOUBLE_EQ(result<double>("ReactionTime"), 0.05);
    EXPECT_DOUBLE_EQ(result<double>("StoppingTime"), 0.05);
}

TEST_F(ForceLimitedSkillTest, AsksForAResetUntilTheArmStands) {
    begin();
    force_->measure(force({0, 0, 21}));
    line_->reset_answer = fail(Errc::resource_unavailable, "the arm still moves");
    line_->halted();
    EXPECT_THAT(line_->heard(), ElementsAre("begin", "halt", "reset"));
    executor_->advance(100ms);
    EXPECT_THAT(line_->heard(), ElementsAre("reset"));
    line_->reset_answer = {};
    executor_->advance(100ms);
    line_->wasReset(fail(Errc::timeout, "it takes its time"));
    executor_->advance(100ms);
    EXPECT_THAT(line_->heard(), ElementsAre("reset", "reset"));
    line_->wasReset();
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::finished);
}

TEST_F(ForceLimitedSkillTest, LeavesAMoveHaltedThatCannotBeReset) {
    begin();
    force_->measure(force({0, 0, 21}));
    line_->reset_answer = fail(Errc::device_fault, "a fault");
    line_->halted();
    turn();
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::finished);
    EXPECT_TRUE(skill_->leftOver()) << "its next use may reset it";
}

TEST_F(ForceLimitedSkillTest, GivesUpAResetAfterFourSeconds) {
    begin();
    force_->measure(force({0, 0, 21}));
    line_->reset_answer = fail(Errc::resource_unavailable, "the arm still moves");
    line_->halted();
    executor_->advance(3'900ms);
    EXPECT_THAT(listener_.ends, IsEmpty());
    executor_->advance(200ms);
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::finished);
}

TEST_F(ForceLimitedSkillTest, HaltsOnForceIfAsked) {
    begin({{"HaltOnForce", true}});
    EXPECT_FALSE(line_->request.parameters.contains("HaltOnForce"));
    force_->measure(force({0, 0, 21}));
    line_->halted();
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::halted);
    EXPECT_EQ(onlyEnd().reason, Reason::force_exceeded);
    EXPECT_EQ(onlyEnd().text,
              "the contact force [0.0, 0.0, 21.0] N in the base frame is over its limit "
              "[0.0, 0.0, 20.0] N");
    EXPECT_TRUE(skill_->leftOver()) << "a later use may reset what was halted here";
}

TEST_F(ForceLimitedSkillTest, TurnsForceAndTorqueIntoTheBaseFrame) {
    begin();
    auto measured = force({25, 0, 0});
    measured.torque = Vector3{0, 2, 0};
    measured.pose = skill::Frame{0.5, 0, 0.4, 0, std::acos(0.0), 0};  // x of the sensor is -z
    force_->measure(measured);
    EXPECT_THAT(line_->heard(), ElementsAre("begin", "halt"));
    line_->halted();
    line_->wasReset();
    const auto contact = result<Vector3>("ContactForce");
    EXPECT_NEAR(contact.x, 0, 1e-12);
    EXPECT_NEAR(contact.z, -25, 1e-12);
    EXPECT_NEAR(result<Vector3>("ContactTorque").y, 2, 1e-12);
}

TEST_F(ForceLimitedSkillTest, EndsBeforeItBeginsAtAForceThatIsThereAlready) {
    force_->now = force({0, 0, 22});
    begin();
    EXPECT_THAT(line_->heard(), IsEmpty());
    EXPECT_THAT(listener_.ends, IsEmpty()) << "never from inside a call";
    skill_->halt();
    EXPECT_THAT(line_->heard(), IsEmpty()) << "somebody else's execution may run";
    turn();
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::finished);
    EXPECT_EQ(result<Vector3>("ForcesExceeded"), (Vector3{0, 0, 22}));
}

TEST_F(ForceLimitedSkillTest, HaltsAMoveWhoseForceIsLost) {
    begin();
    force_->lose({Errc::connection_lost, "the connection to press is lost"});
    force_->lose({Errc::connection_lost, "again"});
    EXPECT_THAT(line_->heard(), ElementsAre("begin", "halt"));
    line_->halted();
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::halted);
    EXPECT_EQ(onlyEnd().reason, Reason::device_lost);
    EXPECT_THAT(onlyEnd().text, HasSubstr("the connection to press is lost"));
    EXPECT_FALSE(skill_->available()) << "nothing begins without a force";
}

TEST_F(ForceLimitedSkillTest, HaltsAMoveWhoseForceIsNotFinite) {
    begin();
    force_->measure(force({0, 0, std::numeric_limits<double>::quiet_NaN()}));
    EXPECT_THAT(line_->heard(), ElementsAre("begin", "halt"));
    line_->halted();
    EXPECT_THAT(onlyEnd().text, HasSubstr("FlangeForce of press is not finite"));
}

TEST_F(ForceLimitedSkillTest, RefusesAStartWithoutForceOrLimit) {
    force_->now = fail(Errc::connection_lost, "press does not answer");
    begin();
    turn();
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::refused);
    EXPECT_EQ(onlyEnd().text, "press does not answer");

    force_->now = force({});
    for (const auto& [limits, text] : {std::pair{Vector3{}, "no axis has a limit over 0 N"},
                                       std::pair{Vector3{0, -1, 0}, "a limit is below 0 N"}}) {
        begin({{"MaxForce", limits}});
        turn();
        EXPECT_THAT(listener_.ends.back().text, HasSubstr(text));
    }
    EXPECT_THAT(line_->heard(), IsEmpty());
}

TEST_F(ForceLimitedSkillTest, HaltsAgainIfItsHaltWasRefused) {
    begin();
    force_->measure(force({0, 0, 21}));
    force_->measure(force({0, 0, 22}));
    EXPECT_THAT(line_->heard(), ElementsAre("begin", "halt"));
    line_->listener->onRefused(skill::Method::halt, {Errc::timeout, "busy"});
    executor_->advance(100ms);
    EXPECT_THAT(line_->heard(), ElementsAre("halt")) << "without any further force";
    line_->halted();
    line_->wasReset();
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::finished);
}

TEST_F(ForceLimitedSkillTest, DoesNotWaitForEverForTheEndOfItsHalt) {
    begin();
    force_->measure(force({0, 0, 21}));
    line_->listener->onRefused(skill::Method::halt, {Errc::not_supported, "it has no Halt"});
    executor_->advance(5'900ms);
    EXPECT_THAT(listener_.ends, IsEmpty());
    executor_->advance(200ms);
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::halted);
    EXPECT_EQ(onlyEnd().text, "did not end within 6 s after Halt (it has no Halt)");
    EXPECT_FALSE(line_->runs()) << "nobody listens to it any more";
}

TEST_F(ForceLimitedSkillTest, AFaultWhileItBrakesIsNoSuccess) {
    begin();
    force_->measure(force({0, 0, 21}));
    line_->stops(State::halted);
    line_->halted(Reason::error, "a protective stop");
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::halted);
    EXPECT_EQ(onlyEnd().text, "a protective stop");
    EXPECT_THAT(line_->heard(), ElementsAre("begin", "halt")) << "a fault is not reset";
    EXPECT_FALSE(skill_->leftOver());
}

TEST_F(ForceLimitedSkillTest, AForceWhileAnotherClientHaltsItIsNoSuccess) {
    begin();
    line_->stops(State::halted, "by somebody");
    EXPECT_THAT(listener_.stops, ElementsAre(State::halted));
    force_->measure(force({0, 0, 21}));
    line_->halted(Reason::by_client, "by somebody");
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::halted);
    EXPECT_THAT(line_->heard(), ElementsAre("begin"));
    EXPECT_FALSE(skill_->leftOver());
}

TEST_F(ForceLimitedSkillTest, TakesAnUnexplainedEndOfAnotherMakersServerForItsHalt) {
    line_->lacks_text = "no atomic start, no dead-man";
    begin();
    force_->measure(force({0, 0, 21}));
    line_->halted(Reason::none);
    line_->wasReset();
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::finished);
}

TEST_F(ForceLimitedSkillTest, MayResetAMoveThatItsHaltReachedAfterTheEnd) {
    begin();
    force_->measure(force({0, 0, 21}));
    line_->finish({{"LargestPathDeviation", 0.001}});
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::finished);
    EXPECT_EQ(result<Vector3>("ForcesExceeded"), (Vector3{0, 0, 21}));
    EXPECT_EQ(result<double>("LargestPathDeviation"), 0.001);
    EXPECT_TRUE(skill_->leftOver()) << "Halt makes a Ready skill Halted";
}

TEST_F(ForceLimitedSkillTest, DoesNotBeginWithAForceThatIsNotFinite) {
    force_->now = force({0, std::numeric_limits<double>::infinity(), 0});
    EXPECT_FALSE(skill_->available());
    begin();
    turn();
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::refused);
    EXPECT_THAT(line_->heard(), IsEmpty());
}

TEST_F(ForceLimitedSkillTest, AHaltOfItsUserIsAHalt) {
    begin();
    skill_->halt();
    line_->stops(State::halted);
    EXPECT_THAT(listener_.stops, ElementsAre(State::halted));
    force_->measure(force({0, 0, 21}));
    line_->halted();
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::halted);
    EXPECT_EQ(onlyEnd().reason, Reason::by_client);
}

TEST_F(ForceLimitedSkillTest, AHaltEndsTheWaitForTheReset) {
    begin();
    force_->measure(force({0, 0, 21}));
    line_->reset_answer = fail(Errc::resource_unavailable, "the arm still moves");
    line_->halted();
    skill_->halt();
    executor_->advance(1s);
    EXPECT_EQ(onlyEnd().kind, UsedSkillEnd::Kind::halted);
}

TEST_F(ForceLimitedSkillTest, WatchesTheForceWhileItIsSuspended) {
    begin();
    ASSERT_TRUE(skill_->suspend());
    line_->suspended();
    force_->measure(force({0, 0, 21}));
    EXPECT_THAT(line_->heard(), ElementsAre("begin", "suspend", "halt"));
}

TEST_F(ForceLimitedSkillTest, PassesOnWhatEndsOtherwise) {
    begin();
    line_->halted(Reason::error, "a protective stop");
    EXPECT_EQ(onlyEnd().reason, Reason::error);
    EXPECT_EQ(onlyEnd().text, "a protective stop");
    EXPECT_FALSE(skill_->leftOver());
}

TEST_F(ForceLimitedSkillTest, HearsOfNoForceAfterItsRelease) {
    begin();
    skill_->release();
    EXPECT_FALSE(force_->heardBySomebody());
}

TEST_F(ForceLimitedSkillTest, ChecksTheMoveAndItsOwnParameters) {
    line_->on_check = [](const skill::CheckRequest& request) {
        EXPECT_FALSE(request.parameters.contains("MaxForce"));
        return skill::CheckReport{.planned_duration = 2.0};
    };
    std::vector<Result<skill::CheckReport>> reports;
    const auto check = [&](Vector3 limits) {
        skill_->check({.parameters = {{"MaxForce", limits}}},
                      [&](Result<skill::CheckReport> report) { reports.push_back(report); });
    };
    check({0, 0, 20});
    check({});
    ASSERT_EQ(reports.size(), 2U);
    ASSERT_TRUE(reports[0]);
    EXPECT_EQ(reports[0]->planned_duration, 2.0);
    ASSERT_TRUE(reports[1]);
    EXPECT_FALSE(reports[1]->possible);
    EXPECT_EQ(reports[1]->code, "out_of_range");
    EXPECT_THAT(reports[1]->reason, HasSubstr("no axis has a limit over 0 N"));
}

}  // namespace
}  // namespace metier::composition
