#include "metier/composition/dot.hpp"

#include <gmock/gmock.h>

#include "metier/composition/definition_file.hpp"

namespace metier::composition {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Dot, DrawsStepsGroupsAndWays) {
    const auto definition = parseDefinition(R"(
name = "TestSkill"
[parameters.Laps]
type = "uint32"
range = [1, 3]
[uses.a]
type = "MoveSkillType"
[uses.b]
type = "GraspSkillType"
[[step]]
name = "both"
[[step.parallel]]
name = "left"
run = "a"
[[step.parallel]]
name = "right"
run = "b"
[[step]]
name = "either"
retry = 2
timeout = 1.5
[[step.fallback]]
name = "gentle"
run = "a"
[[step.fallback]]
name = "rough"
run = "b"
[[step]]
name = "decide"
if = { from = "Laps", greater = 1 }
[[step.then]]
name = "laps"
times = { from = "Laps" }
[[step.then.repeat]]
name = "lap"
run = "a"
)",
                                            "c.toml");
    ASSERT_TRUE(definition) << definition.error().message;
    const auto dot = toDot(*definition);
    for (const auto* part :
         {"digraph \"TestSkill\" {", "subgraph \"cluster_both\" {",
          "\"left\" [label=\"left — MoveSkillType\"];", "begin -> \"left\";", "begin -> \"right\";",
          "\"left\" -> \"gentle\";", "\"right\" -> \"gentle\";",
          "\"gentle\" -> \"rough\" [style=dashed, label=\"failed\"];",
          "either: the first that succeeds, 2 more on failure, within 1.5 s",
          "\"decide\" [shape=diamond, label=\"Laps > 1\"];",
          "\"decide\" -> \"lap\" [label=\"yes\"];", "laps: repeat Laps times",
          "\"lap\" -> \"lap\" [constraint=false, label=\"again\"];", "\"decide\" -> end;",
          "\"lap\" -> end;"}) {
        EXPECT_THAT(dot, HasSubstr(part));
    }
    EXPECT_THAT(dot, Not(HasSubstr("left\" -> \"right\"")));
}

/// A drawing of a skill whose last step is `text`, after two that run skills.
std::string drawingOf(const std::string& text) {
    const auto definition = parseDefinition(R"(
name = "TestSkill"
[parameters.Laps]
type = "uint32"
range = [1, 3]
[parameters.Ok]
type = "boolean"
[parameters.Name]
type = "text"
[parameters.Joints]
type = "numbers"
[uses.a]
type = "MoveSkillType"
[uses.b]
type = "GraspSkillType"
[[step]]
name = "first"
run = "a"
[[step]]
name = "second"
run = "b"
)" + text,
                                            "c.toml");
    EXPECT_TRUE(definition) << definition.error().message;
    return definition ? toDot(*definition) : std::string();
}

TEST(Dot, NamesConditionsAsTheFileSaysThem) {
    struct Case {
        const char* condition;
        const char* text;
    };
    for (const auto& [condition, text] :
         {Case{"{ from = \"Laps\", is = 2 }", "Laps is 2"},
          Case{"{ from = \"Ok\", is = true }", "Ok is true"},
          Case{"{ from = \"Ok\", is = false }", "Ok is false"},
          Case{"{ from = \"Name\", is = \"bolt\" }", "Name is 'bolt'"},
          Case{"{ from = \"Joints\", is = [1, 2] }", "Joints is [2 values]"},
          Case{"{ from = \"first.ReachedPose\", element = \"z\", less = 0.5 }",
               "first.ReachedPose[2] < 0.5"},
          Case{"{ from = \"Joints\", element = 0, greater = { from = \"Joints\", element = 1 } }",
               "Joints[0] > Joints[1]"},
          Case{"{ from = \"Joints\", element = 0, less = { from = \"Laps\", shift = 1 } }",
               "Joints[0] < Laps shifted"},
          Case{"{ from = \"Joints\", is = [1, { from = \"Laps\" }] }", "Joints is [...]"},
          Case{"{ not = { from = \"Ok\", is = true } }", "not (Ok is true)"},
          Case{"{ all = [{ from = \"Laps\", is = 1 }, { from = \"Ok\", is = true }] }",
               "Laps is 1 and Ok is true"},
          Case{"{ any = [{ from = \"Laps\", is = 1 }, { from = \"Ok\", is = true }] }",
               "Laps is 1 or Ok is true"}}) {
        const auto dot = drawingOf("[[step]]\nname = \"decide\"\nif = " + std::string(condition) +
                                   "\n[[step.then]]\nname = \"yes\"\nrun = \"a\"\n");
        EXPECT_THAT(dot,
                    HasSubstr("\"decide\" [shape=diamond, label=\"" + std::string(text) + "\"];"));
        EXPECT_THAT(dot, HasSubstr("label=\"decide: if " + std::string(text) + "\";"));
    }
}

TEST(Dot, NamesWhatGroupsDo) {
    struct Case {
        const char* step;
        const char* title;
    };
    for (const auto& [step, title] :
         {Case{"[[step.sequence]]\n", "group"},
          Case{"[[step.parallel]]\n", "group: all at the same time"},
          Case{"wait_for = \"any\"\n[[step.parallel]]\n",
               "group: at the same time, until one succeeds"},
          Case{"[[step.fallback]]\n", "group: the first that succeeds"},
          Case{"times = 3\n[[step.repeat]]\n", "group: repeat 3 times"},
          Case{"at_most = 9\nwhile = { from = \"Ok\", is = true }\n[[step.repeat]]\n",
               "group: repeat while Ok is true, at most 9"},
          Case{"at_most = 9\nuntil = { from = \"Ok\", is = true }\nretry = 1\n[[step.repeat]]\n",
               "group: repeat until Ok is true, at most 9, 1 more on failure"}}) {
        const auto dot = drawingOf("[[step]]\nname = \"group\"\n" + std::string(step) +
                                   "name = \"within\"\nrun = \"a\"\n");
        EXPECT_THAT(dot, HasSubstr("  subgraph \"cluster_group\" {\n    label=\"" +
                                   std::string(title) + "\";\n    \"within\" [label="));
    }
}

TEST(Dot, LeadsFromStepToStepAndFromBeginToEnd) {
    const auto dot = drawingOf("");
    EXPECT_THAT(dot, HasSubstr("  begin -> \"first\";\n"));
    EXPECT_THAT(dot, HasSubstr("  \"first\" -> \"second\";\n"));
    EXPECT_THAT(dot, HasSubstr("  \"second\" -> end;\n"));
    EXPECT_THAT(dot, Not(HasSubstr("\"first\" -> end")));
    EXPECT_THAT(dot, Not(HasSubstr("begin -> \"second\"")));
}

TEST(Dot, LeadsFromBothWaysOfAChoice) {
    const auto dot = drawingOf(R"(
[[step]]
name = "decide"
if = { from = "Ok", is = true }
[[step.then]]
name = "right"
run = "a"
[[step.else]]
name = "left"
run = "b"
[[step]]
name = "after"
run = "a"
)");
    EXPECT_THAT(dot, HasSubstr("\"decide\" -> \"right\" [label=\"yes\"];"));
    EXPECT_THAT(dot, HasSubstr("\"decide\" -> \"left\" [label=\"no\"];"));
    EXPECT_THAT(dot, HasSubstr("\"right\" -> \"after\";"));
    EXPECT_THAT(dot, HasSubstr("\"left\" -> \"after\";"));
    EXPECT_THAT(dot, Not(HasSubstr("\"decide\" -> \"after\"")));
}

TEST(Dot, LeadsNowhereFromAFailureAndQuotesItsText) {
    const auto dot =
        drawingOf("[[step]]\nname = \"give_up\"\nfail = \"no \\\"part\\\"\\nin C:\\\\box\"\n");
    EXPECT_THAT(dot, HasSubstr("\"second\" -> \"give_up\";"));
    EXPECT_THAT(dot, HasSubstr("\"give_up\" [shape=octagon, label=\"fails: no \\\"part\\\" in "
                               "C:\\\\box\"];"));
    EXPECT_THAT(dot, Not(HasSubstr("-> end")));
}

TEST(Dot, TriesTheNextOfAFallbackOnFailureAlone) {
    const auto dot = drawingOf(R"(
[[step]]
name = "either"
[[step.fallback]]
name = "gentle"
run = "a"
[[step.fallback]]
name = "rough"
run = "b"
[[step.fallback]]
name = "by_hand"
run = "a"
)");
    EXPECT_THAT(dot, HasSubstr("\"second\" -> \"gentle\";"));
    EXPECT_THAT(dot, Not(HasSubstr("\"second\" -> \"rough\"")));
    EXPECT_THAT(dot, HasSubstr("\"gentle\" -> \"rough\" [style=dashed, label=\"failed\"];"));
    EXPECT_THAT(dot, HasSubstr("\"rough\" -> \"by_hand\" [style=dashed, label=\"failed\"];"));
    EXPECT_THAT(dot, Not(HasSubstr("\"gentle\" -> \"by_hand\"")));
    for (const auto* last : {"gentle", "rough", "by_hand"}) {
        EXPECT_THAT(dot, HasSubstr("\"" + std::string(last) + "\" -> end;"));
    }
}

}  // namespace
}  // namespace metier::composition
