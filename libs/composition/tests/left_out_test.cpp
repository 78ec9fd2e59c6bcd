// Steps, parameters and results that a file marks as optional, and that are not there.
#include <gmock/gmock.h>

#include "bench.hpp"

namespace metier::composition {
namespace {

using skill::Value;
using skill::ValueMap;
using testing::Bench;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kHead;
using testing::kHeadWithGrip;

/// `b`, which is optional, watches in the background while `a` moves; `a` has no parameter Width
/// and no result Held.
const std::string kWatched = kHead + R"(optional = true
[parameters.Way]
type = "number"
unit = "m"
default = 2.0
[results.Held]
type = "boolean"
from = "move.Held"
optional = true
[[step]]
name = "carry"
[[step.parallel]]
name = "watch"
run = "b"
background = true
[[step.parallel]]
name = "move"
run = "a"
with.Target = { from = "Way", optional = true }
with.Width = { from = "Way", optional = true }
)";

std::string problemsOf(const std::string& text) {
    const auto definition = parseDefinition(text, "c.toml");
    return definition ? "nothing" : definition.error().message;
}

TEST(WhatIsOptional, RunsWhereItIsServed) {
    Bench bench(kWatched);
    ASSERT_TRUE(bench.start());
    EXPECT_TRUE(bench["a"].runs());
    EXPECT_TRUE(bench["b"].runs());
}

TEST(WhatIsOptional, IsLeftOutWhereNobodyServesIt) {
    Bench bench(kWatched, {"b"});
    EXPECT_THAT(bench.program->description().steps, ElementsAre("carry", "move"));
    ASSERT_TRUE(bench.start());
    EXPECT_TRUE(bench["a"].runs());
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready") << bench.why();
}

TEST(WhatIsOptional, IsNotGivenToASkillWithoutThatParameter) {
    Bench bench(kWatched, {"b"});
    ASSERT_TRUE(bench.start());
    EXPECT_EQ(bench["a"].request.parameters, (ValueMap{{"Target", 2.0}}));
}

TEST(WhatIsOptional, IsNotGivenOnIfTheClientHasNotGivenIt) {
    const auto file = [](const std::string& marked) {
        return kHead + R"(
[parameters.Way]
type = "number"
optional = true
[results.Reached]
type = "number"
from = "move.Reached"
optional = true
[[step]]
name = "move"
run = "a"
with.Target = { from = "Way")" +
               marked + R"( }
[[step]]
name = "next"
run = "b"
)";
    };
    Bench bench(file(", optional = true"));
    ASSERT_TRUE(bench.start());
    EXPECT_EQ(bench["a"].request.parameters, ValueMap{});
    bench["a"].finish();
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready") << bench.why();
    EXPECT_EQ(bench.program->finalResult(), (ValueMap{{"Reached", Value{}}}))
        << "the used skill left it Null";

    Bench given(file(", optional = true"));
    ASSERT_TRUE(given.start({{"Way", 3.0}}));
    EXPECT_EQ(given["a"].request.parameters, (ValueMap{{"Target", 3.0}}));

    Bench needed(file(""));
    ASSERT_TRUE(needed.start());
    EXPECT_EQ(needed.state(), "Halted");
    EXPECT_THAT(needed.why(), HasSubstr("Way has no value"));
}

TEST(WhatIsOptional, IsNullAsAResultThatTheUsedSkillDoesNotGive) {
    Bench bench(kWatched, {"b"});
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.program->finalResult(), (ValueMap{{"Held", Value{}}}));
}

TEST(WhatIsOptional, IsRefusedWhereNothingElseWouldRun) {
    EXPECT_THAT(problemsOf(kHeadWithGrip + R"(optional = true
[[step]]
name = "first"
run = "a"
[[step]]
name = "take"
[[step.fallback]]
name = "grasp"
run = "grip"
[[step.fallback]]
name = "other"
run = "b"
)"),
                HasSubstr("step[1].fallback[0].run: \"grip\" is optional"));
    EXPECT_THAT(problemsOf(kHead + "optional = true\n[[step]]\nname = \"last\"\nrun = \"b\"\n"
                                   "[[step]]\nname = \"group\"\n"
                                   "[[step.sequence]]\nname = \"inner\"\nrun = \"b\"\n"),
                HasSubstr("step[1].sequence[0].run: \"b\" is optional"));
}

TEST(WhatIsOptional, HasNoResultsForOtherSteps) {
    EXPECT_THAT(problemsOf(kHead + R"(optional = true
[[step]]
name = "first"
run = "b"
[[step]]
name = "second"
run = "a"
with.Target = { from = "first.Reached" }
)"),
                HasSubstr("step[1].with.Target"));
}

}  // namespace
}  // namespace metier::composition
