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

TEST(NodeId, IsNoneIfANumberDoesNotFit) {
    EXPECT_EQ(NodeId::parse("ns=65535;i=4294967295"), NodeId(65'535, 4'294'967'295U));
    for (const char* text : {"ns=65536;i=5", "ns=65538;s=Cell", "i=4294967296", "ns=2;i=4294967301",
                             "ns=18446744073709551618;i=5", "i=-1", "i=+5", "ns=-1;i=5"}) {
        EXPECT_FALSE(NodeId::parse(text)) << text;
    }
}

TEST(NodeId, IsNoneOfTextThatLacksAPart) {
    for (const char* text :
         {"", "ns=1", "ns=1;", "ns=;i=5", "i=", "ns=1;i=", "85", "i=85 ", " i=85", "x=4",
          "ns=2;i=5;i=6", "g=09087e75-8e5e-499b-954f-f2a9603db28", "b=AQI", "b=%%"}) {
        EXPECT_FALSE(NodeId::parse(text)) << text;
    }
    EXPECT_EQ(NodeId::parse("ns=1;s="), NodeId(1, "")) << "an empty string is one";
    EXPECT_EQ(NodeId::parse("ns=1;s=a;i=5"), NodeId(1, "a;i=5")) << "a string may hold anything";
}

TEST(NodeId, OfEachKindIsNullWithoutContentInNamespace0) {
    EXPECT_TRUE(NodeId(0, "").isNull());
    EXPECT_TRUE(NodeId(0, Guid{}).isNull());
    EXPECT_TRUE(NodeId(0, ByteString{}).isNull());
    EXPECT_FALSE(NodeId(0, ByteString{{0}}).isNull());
    EXPECT_NE(NodeId(1, ""), NodeId(1, ByteString{})) << "kinds differ";
    EXPECT_NE(NodeId(1, 0U), NodeId());
}

TEST(NodeId, PrintsTextFromTheNetworkWithoutControlCharacters) {
    EXPECT_EQ(NodeId(1, "a\x1b[2J").toString(), "ns=1;s=a\xEF\xBF\xBD[2J");
}

}  // namespace
}  // namespace metier::opcua
