// examples/machine_tending: skills of programs that are not metier's, used beside an arm.
#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

#include "metier_program.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using skill::State;
using ::testing::HasSubstr;

std::filesystem::path tendingCell() {
    return std::filesystem::path(METIER_SOURCE_DIR) / "examples" / "machine_tending" / "cell.toml";
}

class MachineTending : public ::testing::Test {
protected:
    ServerProcess serveTending() {
        return ServerProcess("tending",
                             {"--port", "0", "--use", "iiwa=" + arm_.url(), "--use",
                              "opc.tcp://localhost:48463=" + camera_.url(), "--use",
                              "opc.tcp://localhost:48464=" + door_.url()},
                             tendingCell());
    }

    ServerProcess arm_{"iiwa", {"--port", "0"}, tendingCell()};
    ServerProcess camera_{
        std::vector<std::string>{METIER_EXAMPLE_CAMERA, "--insecure-lab", "--port", "0"}};
    ServerProcess door_{
        std::vector<std::string>{METIER_EXAMPLE_DOOR, "--insecure-lab", "--port", "0"}};
};

TEST_F(MachineTending, UsesACameraADoorAndAnArmAsOneSkill) {
    const ServerProcess tending = serveTending();
    const std::vector<std::string> run{"run", tending.url(), "TendSkill", "--set",
                                       "Machine=0.5,0,0.4,3.14159,0,3.14159"};
    for (int image = 0; image < 2; ++image) {
        const auto ended = runMetier(run);
        EXPECT_EQ(ended.status, 0) << ended.output;
        EXPECT_THAT(ended.output, HasSubstr("Opening"));
    }
    const auto empty = runMetier(run);
    EXPECT_EQ(empty.status, 1) << empty.output;
    EXPECT_THAT(empty.output, HasSubstr("no part is in the image"));
}

TEST_F(MachineTending, TheDoorIsFoundByItsTaskAndRefusesWhatItIsToldWrong) {
    const auto client = connectTo(door_.url());
    auto open = openSkill(*client, "OpenDoorSkill");
    const auto fast = open.startWith({"fast", {{"Speed", 3.0}}});
    ASSERT_FALSE(fast);
    EXPECT_THAT(fast.error().message, HasSubstr("3 m/s is over the limit 2 m/s"));
    const auto found = runMetier({"find", "open", "--at", door_.url()});
    EXPECT_EQ(found.status, 0) << found.output;
    EXPECT_THAT(found.output, HasSubstr("OpenDoorSkill"));
}

TEST_F(MachineTending, TheDoorIsSuspendedAndTakesNoOtherOrderUntilItIsDone) {
    Watched open(door_.url(), "OpenDoorSkill");
    Watched close(door_.url(), "CloseDoorSkill");
    ASSERT_TRUE(open->startWith({"slow", {{"Speed", 0.05}}}));
    open.awaitEvent(State::running);
    const auto refused = close->startWith({"other", {}});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("the door is in use by OpenDoorSkill"));
    ASSERT_TRUE(open->suspend());
    open.awaitEvent(State::suspended);
    EXPECT_FALSE(close->startWith({"again", {}}));
    ASSERT_TRUE(open->halt());
    open.awaitEvent(State::halted);
    EXPECT_TRUE(close->runWith({"close", {}}, inAMinute()));
}

}  // namespace
}  // namespace metier::system_tests
