#include "metier/opcua/types.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <unordered_set>

namespace metier::opcua {
namespace {

using ::testing::HasSubstr;

TEST(NodeId, PrintsAndParsesEveryKindOfIdentifier) {
    for (const char* text : {"i=85", "ns=2;i=15396", "ns=1;s=Robot.Skills/Move",
                             "ns=3;g=09087e75-8e5e-499b-954f-f2a9603db28a", "ns=1;b=AQIDBA=="}) {
        const auto id = NodeId::parse(text);
        ASSERT_TRUE(id) << text;
        EXPECT_EQ(id->toString(), text);
    }
}

TEST(NodeId, SaysWhatCouldNotBeParsed) {
    const auto id = NodeId::parse("ns=x;\n");
    ASSERT_FALSE(id);
    EXPECT_EQ(id.error().code, Errc::invalid_argument);
    EXPECT_THAT(id.error().message, HasSubstr("ns=x;\xEF\xBF\xBD"));
}

TEST(NodeId, IsNullUntilGivenAnIdentifier) {
    EXPECT_TRUE(NodeId().isNull());
    EXPECT_FALSE(NodeId(0, 85U).isNull());
    EXPECT_FALSE(NodeId(1, "a").isNull());
}

TEST(NodeId, ServesAsAKey) {
    const std::unordered_set<NodeId> ids{NodeId(1, "a"), NodeId(2, "a"), NodeId(1, 5U)};
    EXPECT_TRUE(ids.contains(NodeId(1, "a")));
    EXPECT_FALSE(ids.contains(NodeId(1, "b")));
    EXPECT_LT(NodeId(1, 5U), NodeId(2, 1U));
}

TEST(QualifiedName, PrintsItsIndexAndPrintableName) {
    EXPECT_EQ((QualifiedName{2, "Ski\x01lls"}.toString()), "2:Ski\xEF\xBF\xBDlls");
}

}  // namespace
}  // namespace metier::opcua
