#include "metier/cell/limits.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "metier/cell/cell.hpp"

namespace metier::cell {
namespace {

using ::testing::HasSubstr;

Result<CellConfig> cellWith(const std::string& limits) {
    return parseCell(fmt::format(R"(
name = "limited"
[[server]]
name = "moves"
kind = "move"
robot = "opc.tcp://127.0.0.1:4840"
limits = {{ {} }}
)",
                                 limits),
                     "cell.toml");
}

std::string refusalOf(const std::string& limits) {
    const auto cell = cellWith(limits);
    return cell ? std::string() : cell.error().message;
}

TEST(Limits, AreThoseOfTheCellFile) {
    const auto cell = cellWith("sessions = 20, session_timeout = 7.5");
    ASSERT_TRUE(cell) << cell.error().message;
    const auto& limits = cell->servers.front().limits;
    ASSERT_EQ(limits.size(), 2U);
    EXPECT_EQ(limits[0].name, "sessions");
    EXPECT_EQ(limits[0].value, 20);
    EXPECT_EQ(limits[1].name, "session_timeout");
    EXPECT_EQ(limits[1].value, 7.5);
}

TEST(Limits, HoldAtTheirBoundsAndAreRefusedBeyondWithValueBoundsAndUnit) {
    for (const auto& kind : limitKinds()) {
        for (const double bound : {kind.least, kind.most}) {
            EXPECT_EQ(refusalOf(fmt::format("{} = {}", kind.name, bound)), "");
        }
        const double less = kind.whole ? kind.least - 1 : kind.least / 2;
        const double more = kind.whole ? kind.most + 1 : kind.most * 2;
        for (const double wrong : {less, more}) {
            EXPECT_THAT(refusalOf(fmt::format("{} = {}", kind.name, wrong)),
                        HasSubstr(fmt::format("limits.{}: {} is not within {} to {} {}", kind.name,
                                              wrong, kind.least, kind.most, kind.unit)));
        }
    }
}

TEST(Limits, AreNumbers) {
    EXPECT_THAT(refusalOf("sessions = 2.5"), HasSubstr("is not a whole number (sessions)"));
    EXPECT_THAT(refusalOf("sessions = \"many\""), HasSubstr("is not a whole number (sessions)"));
    EXPECT_THAT(refusalOf("session_timeout = true"), HasSubstr("is not a number (s)"));
    EXPECT_THAT(refusalOf("handshake_timeout = nan"), HasSubstr("is not"));
}

TEST(Limits, ThatContradictEachOtherAreRefused) {
    EXPECT_THAT(refusalOf("sessions = 20, secure_channels = 10"),
                HasSubstr("20 is over secure_channels, which is 10"));
    EXPECT_THAT(refusalOf("min_publishing_interval = 2, max_publishing_interval = 1"),
                HasSubstr("2 is over max_publishing_interval, which is 1"));
}

TEST(Limits, ThatAreUnknownAreRefused) {
    EXPECT_THAT(refusalOf("robots = 3"), HasSubstr("robots: unknown key; known here: chunks_per"));
}

}  // namespace
}  // namespace metier::cell
