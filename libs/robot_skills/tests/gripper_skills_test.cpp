#include "metier/robot_skills/gripper_skills.hpp"

#include <gmock/gmock.h>

#include "gripper_bench.hpp"

namespace metier::robot_skills {
namespace {

using device::SafetyState;
using skill::Place;
using skill::State;
using skill::Value;
using ::testing::HasSubstr;

struct GripperSkillsOf : ::testing::Test {
    GripperBench bench;
    HandDrivenGripper& gripper = bench.gripper;
};

TEST_F(GripperSkillsOf, AGripperAreNamedAsThePublishedTypes) {
    for (const auto& name : {kGrasp, kRelease, kMove}) {
        const auto& description = bench.program(name).description();
        EXPECT_EQ(description.name, name);
        EXPECT_EQ(description.type, name);
        EXPECT_TRUE(description.suspendable);
        ASSERT_EQ(description.parameters.size(), 2U);
        EXPECT_EQ(description.parameters[0].name, "Force");
        EXPECT_EQ(description.parameters[0].place, Place::parameter_set);
        EXPECT_EQ(description.parameters[1].place,
                  name == kMove ? Place::parameter_set : Place::options);
    }
}

TEST_F(GripperSkillsOf, AGripperPassForceAndWidthOn) {
    ASSERT_TRUE(bench.start(kGrasp, {{"Force", 20.0}, {"Width", 0.03}}));
    ASSERT_EQ(gripper.asked.size(), 1U);
    EXPECT_EQ(gripper.asked[0].motion, "grasp");
    EXPECT_EQ(gripper.asked[0].request.force, 20.0);
    EXPECT_EQ(gripper.asked[0].request.width, 0.03);
    EXPECT_EQ(bench.program(kGrasp).state(), State::running);
    bench.end(device::GripperOutcome{0.0295, true});
    EXPECT_EQ(bench.program(kGrasp).state(), State::ready);
    EXPECT_EQ(bench.program(kGrasp).finalResult().at("WidthReached"), Value(0.0295));
    EXPECT_EQ(bench.program(kGrasp).finalResult().at("PartHeld"), Value(true));
}

TEST_F(GripperSkillsOf, AGripperLeaveToItWhatIsNullOrZero) {
    ASSERT_TRUE(bench.start(kGrasp, {{"Force", Value{}}, {"Width", Value{}}}));
    EXPECT_FALSE(gripper.asked[0].request.force);
    EXPECT_FALSE(gripper.asked[0].request.width);
    bench.end(device::GripperOutcome{0.03, true});
    ASSERT_TRUE(bench.start(kRelease, {{"Force", 0.0}, {"Width", 0.0}}));
    EXPECT_EQ(gripper.asked[1].motion, "release");
    EXPECT_FALSE(gripper.asked[1].request.force);
    EXPECT_FALSE(gripper.asked[1].request.width);
    bench.end(device::GripperOutcome{0.11, false});
    EXPECT_EQ(bench.program(kRelease).finalResult().at("PartHeld"), Value(false));
}

TEST_F(GripperSkillsOf, AGripperMoveToAnyWidthAlsoZero) {
    ASSERT_TRUE(bench.start(kMove, {{"Width", 0.0}}));
    EXPECT_EQ(gripper.asked[0].motion, "move");
    EXPECT_EQ(gripper.asked[0].request.width, 0.0);
    bench.end(device::GripperOutcome{0.0, false});
    EXPECT_EQ(bench.program(kMove).state(), State::ready);
}

TEST_F(GripperSkillsOf, AGripperMoveOnlyWithAWidth) {
    const auto started = bench.start(kMove);
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().message, HasSubstr("Width"));
}

TEST_F(GripperSkillsOf, AGripperRefuseAForceOverItsLimit) {
    const auto started = bench.start(kGrasp, {{"Force", 100.0}});
    EXPECT_EQ(started.error().code, Errc::out_of_range);
    EXPECT_EQ(started.error().message, "Force: 100 N is not within the gripper's 5 to 80 N");
    EXPECT_EQ(bench.start(kGrasp, {{"Force", 2.0}}).error().code, Errc::out_of_range);
    EXPECT_TRUE(gripper.asked.empty());
    EXPECT_EQ(bench.program(kGrasp).state(), State::ready);
}

TEST_F(GripperSkillsOf, AGripperRefuseAWidthOverItsStroke) {
    const auto started = bench.start(kMove, {{"Width", 0.2}});
    EXPECT_EQ(started.error().code, Errc::out_of_range);
    EXPECT_EQ(started.error().message, "Width: 0.2 m is not within the gripper's 0 to 0.11 m");
    EXPECT_FALSE(bench.start(kMove, {{"Width", -0.01}})) << "already when it is written";
}

TEST_F(GripperSkillsOf, AGripperWithoutForceControlRefuseAForce) {
    gripper.setForceControl(false);
    EXPECT_THAT(bench.start(kGrasp, {{"Force", 20.0}}).error().message,
                HasSubstr("tool has no force control"));
    EXPECT_TRUE(bench.start(kGrasp, {{"Force", 0.0}}));
}

TEST_F(GripperSkillsOf, AGripperThatIsNotReadyAreRefusedWithItsReason) {
    gripper.setSafety({SafetyState::fault, "tool: fast stop: Reset acknowledges it", false});
    const auto started = bench.start(kGrasp);
    EXPECT_EQ(started.error().code, Errc::device_fault);
    EXPECT_THAT(started.error().message, HasSubstr("fast stop"));
    gripper.setSafety({});
    gripper.setMoving(true);
    EXPECT_EQ(bench.start(kGrasp).error().code, Errc::invalid_state);
}

TEST_F(GripperSkillsOf, AGripperExcludeEachOther) {
    ASSERT_TRUE(bench.start(kGrasp));
    gripper.setMoving(false);
    EXPECT_EQ(bench.start(kMove, {{"Width", 0.05}}).error().code, Errc::resource_unavailable);
}

TEST_F(GripperSkillsOf, AGripperAnswerCheckAsStart) {
    const auto report = bench.program(kMove).check(bench.caller, {{"Width", 0.2}});
    EXPECT_FALSE(report.possible);
    EXPECT_THAT(report.reason, HasSubstr("0.11 m"));
    EXPECT_EQ(report.code, "out_of_range");
    const auto fine = bench.program(kMove).check(bench.caller, {{"Width", 0.1}});
    EXPECT_TRUE(fine.possible);
    for (const auto& answer : {report, fine}) {
        EXPECT_TRUE(answer.ends_known && answer.ends.empty()) << "it moves no arm";
    }
    EXPECT_TRUE(gripper.asked.empty());
}

}  // namespace
}  // namespace metier::robot_skills
