#include "start_up.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace metier::edo_driver {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A start-up whose robot and whose time are moved by hand.
class StartUpTest : public ::testing::Test, private Wire {
protected:
    StartUpTest() { start_up_.start(now_); }

    /// Outcome; nothing if it goes on.
    std::optional<Result<void>> tick(std::uint8_t state, std::chrono::milliseconds later = 0ms,
                                     std::uint32_t opcode = 0) {
        now_ += later;
        return start_up_.tick({state, opcode}, now_, *this);
    }
    std::string problem(const std::optional<Result<void>>& ended) const {
        return ended && !*ended ? ended->error().message : "";
    }

    JointLayout layout_{6, true};
    StartUp start_up_{layout_, {2000, 0.06}};
    SteadyTime now_{1000s};
    std::vector<std::string> sent_;

private:
    void send(std::string_view text) noexcept override { sent_.emplace_back(text); }
};

TEST_F(StartUpTest, StartsTheRobotAndThenReleasesItsBrakes) {
    EXPECT_FALSE(tick(MachineState::init));
    EXPECT_THAT(sent_, ElementsAre(HasSubstr("/bridge_init")));
    EXPECT_FALSE(tick(MachineState::command, 1999ms));
    EXPECT_FALSE(tick(MachineState::command, 11s));
    EXPECT_FALSE(tick(MachineState::braked));
    EXPECT_THAT(sent_, ElementsAre(HasSubstr("/bridge_init"), HasSubstr("/bridge_jnt_reset")));
    EXPECT_FALSE(tick(MachineState::command));
    EXPECT_FALSE(tick(MachineState::not_calibrated)) << "on the way to CALIBRATED";
    EXPECT_FALSE(tick(MachineState::not_calibrated, 999ms));
    const auto ended = tick(MachineState::calibrated);
    ASSERT_TRUE(ended);
    EXPECT_TRUE(*ended);
    EXPECT_FALSE(start_up_.running());
    EXPECT_FALSE(tick(MachineState::braked)) << "it is over";
    EXPECT_EQ(sent_.size(), 2U);
}

TEST_F(StartUpTest, OfARobotThatIsReadySendsNothing) {
    const auto ended = tick(MachineState::calibrated);
    ASSERT_TRUE(ended);
    EXPECT_TRUE(*ended);
    EXPECT_THAT(sent_, IsEmpty());
}

TEST_F(StartUpTest, WaitsTwoSecondsForACommandToBegin) {
    EXPECT_FALSE(tick(MachineState::braked));
    EXPECT_FALSE(tick(MachineState::braked, 1999ms));
    EXPECT_EQ(problem(tick(MachineState::braked, 1ms)),
              "the robot dropped the reset without a word: still BRAKED");
}

TEST_F(StartUpTest, WaitsTwelveSecondsForACommandToEnd) {
    EXPECT_FALSE(tick(MachineState::braked));
    EXPECT_FALSE(tick(MachineState::command));
    EXPECT_FALSE(tick(MachineState::command, 11'999ms));
    EXPECT_EQ(problem(tick(MachineState::command, 1ms)), "COMMAND");
}

TEST_F(StartUpTest, SendsEachCommandOnce) {
    EXPECT_FALSE(tick(MachineState::braked));
    EXPECT_FALSE(tick(MachineState::command));
    EXPECT_THAT(problem(tick(MachineState::braked, 1s, MachineState::emergency_stop)),
                HasSubstr("BRAKED (emergency stop): a reset releases the brakes"));
    EXPECT_EQ(sent_.size(), 1U);
    start_up_.start(now_);
    EXPECT_FALSE(tick(MachineState::braked));
    EXPECT_EQ(sent_.size(), 2U) << "the next recovery sends it again";
}

TEST_F(StartUpTest, WaitsForTheCommandOfSomebodyElse) {
    EXPECT_FALSE(tick(MachineState::command));
    EXPECT_FALSE(tick(MachineState::command, 11'999ms));
    EXPECT_THAT(sent_, IsEmpty());
    EXPECT_FALSE(tick(MachineState::braked));
    EXPECT_THAT(sent_, ElementsAre(HasSubstr("/bridge_jnt_reset")));
}

TEST_F(StartUpTest, GivesACalibrationASecondToShow) {
    EXPECT_FALSE(tick(MachineState::not_calibrated, 999ms));
    EXPECT_THAT(problem(tick(MachineState::not_calibrated, 1ms)),
                HasSubstr("NOT_CALIBRATED: a person must"));
    start_up_.start(now_);
    EXPECT_FALSE(tick(MachineState::calibrated, 999ms, MachineState::uncalibrated));
    EXPECT_THAT(problem(tick(MachineState::calibrated, 1ms, MachineState::uncalibrated)),
                HasSubstr("CALIBRATED (a joint is not calibrated)"));
}

TEST_F(StartUpTest, TellsAnErrorAtOnce) {
    EXPECT_EQ(problem(tick(MachineState::error)), "ERROR: the robot must be restarted");
    EXPECT_THAT(sent_, IsEmpty());
}

TEST_F(StartUpTest, DoesNothingOnceItIsCancelled) {
    start_up_.cancel();
    EXPECT_FALSE(tick(MachineState::braked));
    EXPECT_THAT(sent_, IsEmpty());
}

}  // namespace
}  // namespace metier::edo_driver
