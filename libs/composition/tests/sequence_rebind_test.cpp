// A composed skill that is given other skills to use.
#include <gmock/gmock.h>

#include "bench.hpp"

namespace metier::composition {
namespace {

using testing::Bench;
using ::testing::HasSubstr;
using testing::kHead;
using testing::moveDescription;
using testing::ScriptedUsedSkill;

const std::string kOneAfterTheOther = kHead + R"(
[[step]]
name = "first"
run = "a"
with.Target = 1
[[step]]
name = "second"
run = "a"
[[step]]
name = "third"
run = "b"
)";

using UsedSkills = std::map<std::string, std::unique_ptr<UsedSkill>>;

class RebindOfASequence : public ::testing::Test {
protected:
    /// Another skill for the alias `a`.
    UsedSkills other(const skill::SkillDescription& description = moveDescription()) {
        auto used = std::make_unique<ScriptedUsedSkill>("other", description);
        other_ = used.get();
        UsedSkills used_skills;
        used_skills.emplace("a", std::move(used));
        return used_skills;
    }

    Bench bench_{kOneAfterTheOther};
    ScriptedUsedSkill* other_ = nullptr;  // owned by the map, later by the skill
};

TEST_F(RebindOfASequence, TakesPlaceForTheNextExecution) {
    auto used_skills = other();
    const auto rebound = bench_.skill->rebind(used_skills);
    ASSERT_TRUE(rebound) << rebound.error().message;
    EXPECT_EQ(used_skills.at("a").get(), &bench_["a"]) << "the old one is handed back";
    ASSERT_TRUE(bench_.start());
    EXPECT_TRUE(other_->runs());
    EXPECT_FALSE(bench_["a"].runs());
    EXPECT_EQ(other_->request.parameters.at("Target"), skill::Value(1.0));
}

TEST_F(RebindOfASequence, IsRefusedInTheMiddleOfAnExecution) {
    ASSERT_TRUE(bench_.start());
    bench_["a"].finish();  // between two steps that use it
    auto used_skills = other();
    const auto rebound = bench_.skill->rebind(used_skills);
    ASSERT_FALSE(rebound);
    EXPECT_EQ(rebound.error().code, Errc::invalid_state);
    EXPECT_EQ(used_skills.at("a").get(), other_);
    bench_.run();
    EXPECT_TRUE(bench_["a"].runs()) << "the second step is the old one's as well";
}

TEST_F(RebindOfASequence, IsRefusedWhileItIsSuspended) {
    ASSERT_TRUE(bench_.start());
    ASSERT_TRUE(bench_.call(skill::Method::suspend));
    bench_["a"].suspended();
    bench_.run();
    ASSERT_EQ(bench_.state(), "Suspended");
    auto used_skills = other();
    EXPECT_FALSE(bench_.skill->rebind(used_skills));
}

TEST_F(RebindOfASequence, IsPossibleOnceTheExecutionIsOver) {
    ASSERT_TRUE(bench_.start());
    bench_["a"].refused("broken");
    bench_.run();
    ASSERT_EQ(bench_.state(), "Halted");
    auto used_skills = other();
    EXPECT_TRUE(bench_.skill->rebind(used_skills));
    ASSERT_TRUE(bench_.call(skill::Method::reset));
    ASSERT_TRUE(bench_.call(skill::Method::start));
    EXPECT_TRUE(other_->runs());
}

TEST_F(RebindOfASequence, DoesNotResetASkillThatSomebodyElseHalted) {
    auto used_skills = other();
    other_->state_now = skill::State::halted;
    ASSERT_TRUE(bench_.skill->rebind(used_skills));
    const auto started = bench_.start();
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().message, HasSubstr("other (a) is Halted"));
}

TEST_F(RebindOfASequence, IsRefusedWhereTheBindingsDoNotFit) {
    auto narrow = moveDescription();
    auto parameters = narrow.parameters.toVector();
    parameters.front().range = skill::Range{0.0, 0.5};
    narrow.parameters = std::move(parameters);
    auto used_skills = other(narrow);
    const auto rebound = bench_.skill->rebind(used_skills);
    ASSERT_FALSE(rebound);
    EXPECT_EQ(rebound.error().code, Errc::invalid_argument);
    EXPECT_THAT(rebound.error().message, HasSubstr("Target"));
    ASSERT_TRUE(bench_.start());
    EXPECT_TRUE(bench_["a"].runs()) << "nothing has changed";
}

TEST(RebindOfWhatIsOptional, GivesAnotherSkillWhatTheOneBeforeDidNotTake) {
    Bench bench(R"(
name = "TestSkill"
rest_time = 2
[uses.a]
type = "MoveSkillType"
[parameters.Share]
type = "number"
default = 0.25
[results.Force]
type = "number"
from = "move.Force"
optional = true
[[step]]
name = "move"
run = "a"
with.Share = { from = "Share", optional = true }
)");
    auto description = moveDescription();
    auto parameters = description.parameters.toVector();
    parameters.push_back({.name = "Share", .type = skill::ValueType::number, .optional = true});
    description.parameters = std::move(parameters);
    auto results = description.results.toVector();
    results.push_back({.name = "Force", .type = skill::ValueType::number});
    description.results = std::move(results);
    auto used = std::make_unique<ScriptedUsedSkill>("other", description);
    auto& other = *used;
    UsedSkills used_skills;
    used_skills.emplace("a", std::move(used));
    const auto rebound = bench.skill->rebind(used_skills);
    ASSERT_TRUE(rebound) << rebound.error().message;
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(other.request.parameters.contains("Share"));
    EXPECT_EQ(other.request.parameters.at("Share"), skill::Value(0.25));
    other.finish({{"Force", 3.0}});
    bench.run();
    EXPECT_EQ(bench.program->finalResult().at("Force"), skill::Value(3.0)) << bench.why();
}

TEST_F(RebindOfASequence, KnowsOnlyItsOwnAliases) {
    auto used_skills = other();
    auto node = used_skills.extract("a");
    node.key() = "c";
    used_skills.insert(std::move(node));
    EXPECT_EQ(bench_.skill->rebind(used_skills).error().code, Errc::not_found);
}

}  // namespace
}  // namespace metier::composition
