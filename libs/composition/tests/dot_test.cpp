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

}  // namespace
}  // namespace metier::composition
