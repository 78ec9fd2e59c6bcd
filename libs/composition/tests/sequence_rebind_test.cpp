// A composed skill that is given other skills to use.
#include <gmock/gmock.h>

#include "bench.hpp"

namespace metier::composition {
namespace {

using testing::Bench;
using ::testing::HasSubstr;
using testing::kHead;
using testing::moveDescription;
using testing::ScriptedChild;

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

using Children = std::map<std::string, std::unique_ptr<Child>>;

class RebindOfASequence : public ::testing::Test {
protected:
    /// Another skill for the alias `a`.
    Children other(const skill::SkillDescription& description = moveDescription()) {
        auto child = std::make_unique<ScriptedChild>("other", description);
        other_ = child.get();
        Children children;
        children.emplace("a", std::move(child));
        return children;
    }

    Bench bench_{kOneAfterTheOther};
    ScriptedChild* other_ = nullptr;  // owned by the map, later by the skill
};

TEST_F(RebindOfASequence, TakesPlaceForTheNextExecution) {
    auto children = other();
    const auto rebound = bench_.skill->rebind(children);
    ASSERT_TRUE(rebound) << rebound.error().message;
    EXPECT_EQ(children.at("a").get(), &bench_["a"]) << "the old one is handed back";
    ASSERT_TRUE(bench_.start());
    EXPECT_TRUE(other_->runs());
    EXPECT_FALSE(bench_["a"].runs());
    EXPECT_EQ(other_->request.parameters.at("Target"), skill::Value(1.0));
}

TEST_F(RebindOfASequence, IsRefusedInTheMiddleOfAnExecution) {
    ASSERT_TRUE(bench_.start());
    bench_["a"].finish();  // between two steps that use it
    auto children = other();
    const auto rebound = bench_.skill->rebind(children);
    ASSERT_FALSE(rebound);
    EXPECT_EQ(rebound.error().code, Errc::invalid_state);
    EXPECT_EQ(children.at("a").get(), other_);
    bench_.run();
    EXPECT_TRUE(bench_["a"].runs()) << "the second step is the old one's as well";
}

TEST_F(RebindOfASequence, IsRefusedWhileItIsSuspended) {
    ASSERT_TRUE(bench_.start());
    ASSERT_TRUE(bench_.call(skill::Method::suspend));
    bench_["a"].suspended();
    bench_.run();
    ASSERT_EQ(bench_.state(), "Suspended");
    auto children = other();
    EXPECT_FALSE(bench_.skill->rebind(children));
}

TEST_F(RebindOfASequence, IsPossibleOnceTheExecutionIsOver) {
    ASSERT_TRUE(bench_.start());
    bench_["a"].refused("broken");
    bench_.run();
    ASSERT_EQ(bench_.state(), "Halted");
    auto children = other();
    EXPECT_TRUE(bench_.skill->rebind(children));
    ASSERT_TRUE(bench_.call(skill::Method::reset));
    ASSERT_TRUE(bench_.call(skill::Method::start));
    EXPECT_TRUE(other_->runs());
}

TEST_F(RebindOfASequence, DoesNotResetASkillThatSomebodyElseHalted) {
    auto children = other();
    other_->state_now = skill::State::halted;
    ASSERT_TRUE(bench_.skill->rebind(children));
    const auto started = bench_.start();
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().message, HasSubstr("other (a) is Halted"));
}

TEST_F(RebindOfASequence, IsRefusedWhereTheBindingsDoNotFit) {
    auto narrow = moveDescription();
    auto parameters = narrow.parameters.toVector();
    parameters.front().range = skill::Range{0.0, 0.5};
    narrow.parameters = std::move(parameters);
    auto children = other(narrow);
    const auto rebound = bench_.skill->rebind(children);
    ASSERT_FALSE(rebound);
    EXPECT_EQ(rebound.error().code, Errc::invalid_argument);
    EXPECT_THAT(rebound.error().message, HasSubstr("Target"));
    ASSERT_TRUE(bench_.start());
    EXPECT_TRUE(bench_["a"].runs()) << "nothing has changed";
}

TEST_F(RebindOfASequence, KnowsOnlyItsOwnAliases) {
    auto children = other();
    auto node = children.extract("a");
    node.key() = "c";
    children.insert(std::move(node));
    EXPECT_EQ(bench_.skill->rebind(children).error().code, Errc::not_found);
}

}  // namespace
}  // namespace metier::composition
