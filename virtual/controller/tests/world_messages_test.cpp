#include "metier/virtual_controller/world_messages.hpp"

#include <gtest/gtest.h>

namespace metier::virtual_controller {
namespace {

TEST(WorldMessages, KeepAReport) {
    NamedReport sent{"iiwa",
                     {1.5, motion::Pose{{0.1, 0.2, 0.3}, {0.6, 0.8, 0.0, 0.0}}, 0.05, true}};
    const auto line = toLine(sent);
    EXPECT_EQ(line.back(), '\n');
    const auto got = reportOf(line).value();
    EXPECT_EQ(got.name, "iiwa");
    EXPECT_EQ(got.report.time, 1.5);
    EXPECT_EQ(got.report.base_from_flange->translation, sent.report.base_from_flange->translation);
    EXPECT_DOUBLE_EQ(got.report.base_from_flange->rotation.x(), 0.8);
    EXPECT_EQ(got.report.jaw_width, 0.05);
    EXPECT_TRUE(got.report.gripping);
}

TEST(WorldMessages, KeepAnEffect) {
    WorldEffect sent;
    sent.wrench.force = {1, 2, 3};
    sent.wrench.torque = {4, 5, 6};
    const auto without = effectOf(toLine(sent)).value();
    EXPECT_EQ(without.wrench.torque, sent.wrench.torque);
    EXPECT_FALSE(without.part_width);
    sent.part_width = 0.03;
    EXPECT_EQ(effectOf(toLine(sent))->part_width, 0.03);
}

TEST(WorldMessages, AreRefusedIfTheyAreNone) {
    for (const auto* line : {"", "{", "[]", "{}", R"({"name":3})", R"({"wrench":[1,2]})"}) {
        EXPECT_FALSE(reportOf(line)) << line;
        EXPECT_FALSE(effectOf(line)) << line;
    }
    EXPECT_FALSE(reportOf(R"({"name":"a","flange":[0,0,0,0,0,0,0]})")->report.base_from_flange);
    EXPECT_FALSE(reportOf(R"({"name":"a","jaws":"wide"})")->report.jaw_width);
}

TEST(WorldMessages, RefuseARotationTooLongToBeANumber) {
    EXPECT_FALSE(
        reportOf(R"({"name":"a","flange":[0,0,0,1e200,1e200,0,0]})")->report.base_from_flange);
}

}  // namespace
}  // namespace metier::virtual_controller
