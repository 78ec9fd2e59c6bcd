// The robot of docs/guide/add-a-robot.md: its driver and its virtual controller are built from
// examples/05_robot, and it behaves as every other robot.
#include <gmock/gmock.h>

#include <chrono>

#include "metier_program.hpp"
#include "running_cell.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::State;
using ::testing::HasSubstr;

std::filesystem::path ternCell() {
    return std::filesystem::path(METIER_SOURCE_DIR) / "examples" / "05_robot" / "cell.toml";
}

TEST(AddedRobot, MovesAlongASquare) {
    const RunningCell cell(ternCell());
    const auto square = runMetier({"square", "--laps", "1", cell.url("tern")});
    EXPECT_EQ(square.status, 0) << square.output;
}

TEST(AddedRobot, HaltsWhenItsControllerIsGoneAndIsResetWhenItIsBack) {
    const RunningCell cell(ternCell());
    const auto client = connectTo(cell.url("tern"));
    auto skill = openSkill(*client, "JointPtpMoveSkill");
    const auto home = jointPosition(*client, skill);
    auto target = home;
    target.front() += 1.0;
    ASSERT_TRUE(skill.set("TargetJointPosition", target));
    ASSERT_TRUE(skill.set("SpeedOverride", 0.2));
    ASSERT_TRUE(skill.start());
    cell.inject("tern-controller", "cut-link");
    const auto halted = skill.awaitEnd(inAMinute());
    ASSERT_TRUE(halted);
    EXPECT_EQ(halted->to, State::halted);
    EXPECT_EQ(halted->reason, skill::Reason::device_lost);
    EXPECT_THAT(halted->reason_text, HasSubstr("tern"));
    EXPECT_FALSE(skill.reset());
    cell.inject("tern-controller", "restore-link");
    const auto deadline = inAMinute();
    while (!skill.reset() && std::chrono::steady_clock::now() < deadline) {
    }
    EXPECT_EQ(skill.state().value_or(State::halted), State::ready);
    EXPECT_TRUE(skill.run({{"TargetJointPosition", home}}, inAMinute()));
}

TEST(AddedRobot, ShowsItsControllerWhatItIsMadeToSuffer) {
    const RunningCell cell(ternCell());
    const auto address = cell.virtualAddress("tern-controller");
    EXPECT_THAT(runMetier({"virtual", "inject", address}).output, HasSubstr("protective-stop"));
    const auto unknown = runMetier({"virtual", "inject", address, "explode"});
    EXPECT_EQ(unknown.status, 2);
    EXPECT_THAT(unknown.output, HasSubstr("protective-stop"));
    cell.inject("tern-controller", "protective-stop");
    EXPECT_THAT(runMetier({"virtual", "state", address}).output, HasSubstr("\"running\": false"));
}

}  // namespace
}  // namespace metier::system_tests
