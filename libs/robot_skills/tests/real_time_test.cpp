#include <gtest/gtest.h>

#include <memory>

#include "bench.hpp"
#include "metier/joint_simulator/simulator_drive.hpp"

namespace metier::robot_skills {
namespace {

using namespace std::chrono_literals;
using skill::Frame;
using skill::State;
using skill::ValueMap;

const ValueMap kUp{{"TargetPosition", Frame{0, 0, 0.05}}, {"Relative", std::int32_t{1}}};
/// So slow that it is under way still, however long the test is held up.
const ValueMap kSlowlyUp{
    {"TargetPosition", Frame{0, 0, 0.05}}, {"Relative", std::int32_t{1}}, {"SpeedOverride", 0.05}};

/// The bench of the other tests, but its arm runs on its own threads.
class RunningArm : public ::testing::TestWithParam<const char*> {
protected:
    bool runUntil(const std::string& skill, State state) {
        return bench.executor().runUntil([&] { return bench.program(skill).state() == state; },
                                         20s);
    }

    Bench bench{GetParam()};
    joint_simulator::SimulatorDrive drive{bench.arm()};
};

TEST_P(RunningArm, RunsALineToItsEnd) {
    const auto from = bench.commandedPose().translation.z();
    ASSERT_TRUE(bench.start(kCartesianLinear, kUp));
    ASSERT_TRUE(runUntil(kCartesianLinear, State::ready))
        << bench.program(kCartesianLinear).reasonText();
    EXPECT_NEAR(bench.commandedPose().translation.z(), from + 0.05, 1e-9);
    RecordProperty("missed_cycles", static_cast<int>(bench.arm().state().missed_cycles));
}

TEST_P(RunningArm, IsSuspendedResumedAndHalted) {
    auto& line = bench.program(kCartesianLinear);
    ASSERT_TRUE(bench.start(kCartesianLinear, kSlowlyUp));
    ASSERT_TRUE(line.suspend(bench.caller()));
    ASSERT_TRUE(runUntil(kCartesianLinear, State::suspended)) << line.reasonText();
    EXPECT_TRUE(bench.arm().state().standstill);
    ASSERT_TRUE(line.resume(bench.caller()));
    ASSERT_TRUE(line.halt(bench.caller()));
    ASSERT_TRUE(runUntil(kCartesianLinear, State::halted));
    EXPECT_TRUE(bench.arm().state().standstill);
    EXPECT_EQ(line.reason(), skill::Reason::by_client);
    EXPECT_TRUE(line.reset(bench.caller()));
}

TEST_P(RunningArm, IsStoppedByItsController) {
    ASSERT_TRUE(bench.start(kCartesianLinear, kSlowlyUp));
    bench.arm().protectiveStop("fence opened");
    ASSERT_TRUE(runUntil(kCartesianLinear, State::halted));
    EXPECT_NE(bench.program(kCartesianLinear).reasonText().find("fence opened"), std::string::npos);
}

TEST_P(RunningArm, ForgetsAStreamWhoseProgramIsGone) {
    const auto joints = bench.commanded();
    ASSERT_TRUE(bench.start(kPositionStream, {}));
    ASSERT_TRUE(bench.program(kPositionStream)
                    .write(bench.caller(), "TargetJointPosition",
                           std::vector<double>(joints.begin(), joints.end())));
    bench.destroyProgram(kPositionStream);
    EXPECT_EQ(bench.arm().state().safety, device::SafetyState::normal);
}

INSTANTIATE_TEST_SUITE_P(All, RunningArm, ::testing::Values("ur5", "iiwa7", "edo"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace metier::robot_skills
