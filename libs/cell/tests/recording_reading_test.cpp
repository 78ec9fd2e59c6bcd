#include <gmock/gmock.h>

#include "metier/cell/cell.hpp"

namespace metier::cell {
namespace {

using testing::HasSubstr;

constexpr const char* kMove = R"(
[[server]]
name = "move"
kind = "move"
robot = "opc.tcp://10.0.0.1:4840"
)";

Result<CellConfig> parse(const std::string& before, const std::string& of_server) {
    return parseCell("name = \"demo\"\n" + before + kMove + of_server, "/cells/demo.toml");
}

TEST(RecordsOfACell, AreUpToWhoeverStartsItUnlessItSaysWhere) {
    const auto cell = parse("", "");
    ASSERT_TRUE(cell) << cell.error().message;
    EXPECT_EQ(cell->servers[0].records.url, "");
    EXPECT_EQ(cell->servers[0].records.keep_days, 90.0);
    EXPECT_EQ(cell->servers[0].records.keep_megabytes, 2000.0);
}

TEST(RecordsOfACell, AreInAFileBesideItOrInADatabase) {
    const auto url = [](const std::string& text) {
        const auto cell = parse("[records]\nurl = \"" + text + "\"\nkeep_days = 7\n", "");
        return cell ? cell->servers[0].records.url : cell.error().message;
    };
    EXPECT_EQ(url("all.db"), "/cells/all.db");
    EXPECT_EQ(url("sqlite:../all.db"), "/all.db");
    EXPECT_EQ(url("/var/lib/all.db"), "/var/lib/all.db");
    EXPECT_EQ(url("postgresql://metier@db/metier"), "postgresql://metier@db/metier");
    EXPECT_EQ(url("off"), "off");
}

TEST(RecordsOfACell, AreNotKeptForLessThanNoTime) {
    const auto cell = parse("[records]\nkeep_days = -1\nkeep_megabytes = 1e12\n", "");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("keep_days: -1 is not within 0 to 36500"));
    EXPECT_THAT(cell.error().message, HasSubstr("keep_megabytes"));
}

TEST(MetricsOfAServer, AreToldNowhereUnlessItSaysWhere) {
    const auto none = parse("", "");
    ASSERT_TRUE(none);
    EXPECT_FALSE(none->servers[0].metrics);
    const auto some = parse("", "metrics = \"9464\"\n");
    ASSERT_TRUE(some) << some.error().message;
    ASSERT_TRUE(some->servers[0].metrics);
    EXPECT_EQ(some->servers[0].metrics->host, "127.0.0.1");
    EXPECT_EQ(some->servers[0].metrics->port, 9464);
}

TEST(MetricsOfAServer, HaveAnAddressAndAPort) {
    EXPECT_EQ(parseHttpAddress("10.1.2.3:80")->host, "10.1.2.3");
    EXPECT_EQ(parseHttpAddress("[::1]:80")->host, "::1");
    EXPECT_EQ(parseHttpAddress("0")->port, 0);
    for (const auto* wrong : {"", ":", "host:", ":80", "80a", "1.2.3.4:65536", "-1", "host:1:x"}) {
        EXPECT_FALSE(parseHttpAddress(wrong)) << wrong;
    }
    const auto cell = parse("", "metrics = \"lo:cal\"\n");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("metrics: \"lo:cal\" is not ADDRESS:PORT"));
}

}  // namespace
}  // namespace metier::cell
