// The small parts of the driver, each on its own.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "arm_bench.hpp"
#include "cabinet_settings.hpp"
#include "commands.hpp"
#include "controller_planned_run.hpp"
#include "flange_force.hpp"
#include "metier/motion/frame.hpp"
#include "motion_check.hpp"
#include "readiness.hpp"

namespace metier::iiwa_driver {
namespace {

using device::ControllerPlannedMotion;
using device::SafetyState;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const double kNan = std::numeric_limits<double>::quiet_NaN();

// ---- texts ----

TEST(IiwaTexts, NameEveryCommandWithItsCode) {
    const std::vector<std::pair<int, std::string>> names{{0, "state"},
                                                         {101, "cancel"},
                                                         {102, "joint move"},
                                                         {103, "Cartesian move"},
                                                         {201, "joint velocity"},
                                                         {202, "joint acceleration"},
                                                         {204, "Cartesian velocity"},
                                                         {205, "Cartesian acceleration"},
                                                         {211, "force condition"},
                                                         {302, "control interface"},
                                                         {303, "motion type"},
                                                         {304, "control mode"},
                                                         {305, "execution type"},
                                                         {400, "tool"}};
    for (const auto& [code, name] : names) {
        EXPECT_EQ(describe({static_cast<Code>(code), {}}), fmt::format("{} ({})", name, code));
    }
}

TEST(IiwaTexts, NameEveryErrorOfTheCabinet) {
    EXPECT_EQ(errorText(0), "");
    EXPECT_EQ(errorText(-10), "");
    EXPECT_EQ(errorText(-11), "value not accepted");
    EXPECT_EQ(errorText(-12), "no such joint");
    EXPECT_EQ(errorText(-13), "synchronous motion failed");
    EXPECT_EQ(errorText(-14), "asynchronous motion failed");
    EXPECT_EQ(errorText(-15), "impedance not accepted");
    EXPECT_EQ(errorText(-16), "not possible in the present configuration");
    EXPECT_EQ(errorText(-17), "error of the robot application");
}

// ---- settings ----

std::vector<int> codesOf(CommandList& list) {
    std::vector<int> codes;
    for (; !list.empty(); list.drop()) {
        codes.push_back(static_cast<int>(list.front().code));
    }
    return codes;
}

TEST(CabinetSettings, AreToldWhereTheyAreNotKnown) {
    CabinetSettings settings;
    const auto toTell = [&](const Command& command) {
        CommandList list;
        settings.require(command, list);
        return codesOf(list);
    };
    EXPECT_THAT(toTell(jointVelocity(0.5)), ElementsAre(201));
    settings.taken(jointVelocity(0.5));
    settings.taken(forceConditionOff());
    EXPECT_THAT(toTell(jointVelocity(0.5)), IsEmpty());
    EXPECT_THAT(toTell(forceConditionOff()), IsEmpty()) << "although NaN is not NaN";
    EXPECT_THAT(toTell(jointVelocity(0.25)), ElementsAre(201));
    settings.taken(jointVelocity(0.25));
    EXPECT_THAT(toTell(jointVelocity(0.25)), IsEmpty());
    settings.refused(jointVelocity(0.75));
    EXPECT_THAT(toTell(jointVelocity(0.25)), ElementsAre(201)) << "what it has now is not known";
    EXPECT_THAT(toTell(forceConditionOff()), IsEmpty()) << "another setting";
    settings.refused(jointVelocity(0.75));
    settings.forget();
    EXPECT_THAT(toTell(forceConditionOff()), ElementsAre(211));
}

TEST(CabinetSettings, AreNoMotions) {
    CabinetSettings settings;
    const auto move = moveJoints(ArmBench::toJoints(0.1).target_joints);
    settings.taken(move);
    settings.taken(cancel());
    CommandList list;
    settings.require(move, list);
    settings.require(cancel(), list);
    EXPECT_THAT(codesOf(list), ElementsAre(102, 101)) << "each is a new one";
}

// ---- ready to move ----

class ReadinessTest : public ::testing::Test {
protected:
    ReadinessTest() {
        answer_.velocity = device::JointArray(kAxes);
        answer_.ready = true;
    }
    bool notReadyAfter(double seconds) {
        readiness_.take(answer_, seconds);
        return readiness_.notReady();
    }

    CabinetState answer_;
    Readiness readiness_;
};

TEST_F(ReadinessTest, MayBeMissingForAMomentAtRest) {
    answer_.ready = false;
    EXPECT_FALSE(notReadyAfter(0.19));
    EXPECT_TRUE(notReadyAfter(0.01));
    answer_.ready = true;
    EXPECT_FALSE(notReadyAfter(0.01));
    answer_.ready = false;
    EXPECT_FALSE(notReadyAfter(0.19)) << "counted anew";
}

TEST_F(ReadinessTest, SaysNothingOfAMovingArmThatIsNeverReadyMeanwhile) {
    answer_.ready = false;
    answer_.active = true;
    answer_.velocity[3] = 0.5;
    EXPECT_FALSE(notReadyAfter(10.0));
    answer_.active = false;
    EXPECT_FALSE(notReadyAfter(1.0)) << "it still moves";
    answer_.velocity[3] = 0.0;
    EXPECT_TRUE(notReadyAfter(0.0));
}

TEST_F(ReadinessTest, IsMissedSoonByAnArmThatWasReadyWhileItMoved) {
    answer_.velocity[3] = 0.5;
    EXPECT_FALSE(notReadyAfter(0.01));
    answer_.ready = false;
    EXPECT_FALSE(notReadyAfter(0.029));
    EXPECT_TRUE(notReadyAfter(0.001));
    answer_.velocity[3] = 0.0;
    EXPECT_TRUE(notReadyAfter(0.01)) << "until it is ready again";
}

// ---- motions that may be asked for ----

class MotionCheckTest : public ::testing::Test {
protected:
    std::string problem() const {
        const auto checked = checkMotion(model, motion);
        return checked ? "" : checked.error().message;
    }

    const motion::RobotModel model = iiwa7();
    ControllerPlannedMotion motion = ArmBench::toJoints(0.1);
};

TEST_F(MotionCheckTest, SharesAreOverZeroUpToOne) {
    for (auto* share : {&motion.velocity_share, &motion.acceleration_share}) {
        *share = 1.0;
        EXPECT_EQ(problem(), "");
        for (const double bad : {0.0, -0.5, 1.001, kNan}) {
            *share = bad;
            EXPECT_THAT(problem(), HasSubstr("must be over 0, up to 1")) << bad;
        }
        *share = 0.01;
        EXPECT_EQ(problem(), "");
    }
    motion.velocity_share = 2.0;
    EXPECT_THAT(problem(), HasSubstr("velocity share 2"));
    motion.velocity_share = 1.0;
    motion.acceleration_share = 3.0;
    EXPECT_THAT(problem(), HasSubstr("acceleration share 3"));
}

TEST_F(MotionCheckTest, LimitsOfLinesAreZeroOrMore) {
    for (auto* limit : {&motion.line_velocity, &motion.line_acceleration}) {
        for (const double bad : {-0.1, kNan, std::numeric_limits<double>::infinity()}) {
            *limit = bad;
            EXPECT_THAT(problem(), HasSubstr("must be 0 or more")) << bad;
        }
        *limit = 0.0;
        EXPECT_EQ(problem(), "");
    }
}

TEST_F(MotionCheckTest, LimitsOfForcesAreZeroOrMoreOnEachAxis) {
    motion.until = device::ForceCondition{};
    EXPECT_EQ(problem(), "");
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double bad : {-1.0, kNan}) {
            motion.until = device::ForceCondition{};
            motion.until->force[axis] = bad;
            EXPECT_THAT(problem(), HasSubstr("force limit [N]")) << axis;
        }
    }
}

TEST_F(MotionCheckTest, ATargetHasSevenAxesWithinTheirRanges) {
    const double upper = model.limits(6).upper;
    const double lower = model.limits(6).lower;
    for (const double inside : {upper, lower, upper + 5e-7, lower - 5e-7}) {
        motion.target_joints[6] = inside;
        EXPECT_EQ(problem(), "") << inside;
    }
    for (const double outside : {upper + 2e-6, lower - 2e-6, kNan}) {
        motion.target_joints[6] = outside;
        EXPECT_THAT(problem(), HasSubstr("axis 7: target")) << outside;
    }
    motion.target_joints = device::JointArray(6);
    EXPECT_EQ(problem(), "a target of 6 axes, the arm has 7");
}

TEST_F(MotionCheckTest, ATargetPoseIsFinite) {
    const auto home = motion::toFrame(model.kinematics().forward(model.home()));
    motion.target_flange = home;
    EXPECT_EQ(problem(), "");
    for (auto Frame::*part : {&Frame::x, &Frame::y, &Frame::z, &Frame::a, &Frame::b, &Frame::c}) {
        motion.target_flange = home;
        (*motion.target_flange).*part = kNan;
        EXPECT_EQ(problem(), "a target pose that is not finite");
    }
}

TEST(SameFlange, MayBeTwoMillimetresAndTenMilliradiansOff) {
    const motion::Pose here = motion::Pose::identity();
    const auto off = [](double distance, double angle) {
        return motion::Pose{{0.0, distance, 0.0},
                            Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()))};
    };
    EXPECT_TRUE(checkSameFlange(here, off(0.0019, 0.0099)));
    EXPECT_THAT(checkSameFlange(here, off(0.0021, 0.0)).error().message,
                HasSubstr("0.0021 m and 0.0000 rad from"));
    EXPECT_THAT(checkSameFlange(here, off(0.0, 0.0101)).error().message,
                HasSubstr("0.0000 m and 0.0101 rad from"));
}

// ---- how a motion ends ----

TEST(OutcomeOfAMotion, TellsWhyItFailed) {
    using Cause = RunEnd::Cause;
    RunEnd end;
    end.command = jointVelocity(0.5);
    end.miss = {Miss::Quantity::axis, 1, 0.0135, 0.002};
    const auto text = [&](Cause cause) {
        end.cause = cause;
        const auto outcome = outcomeOf(end, "iiwa", "gone");
        return outcome ? "" : outcome.error().message;
    };
    for (const auto cause : {Cause::at_target, Cause::stopped, Cause::force}) {
        EXPECT_EQ(text(cause), "");
    }
    const std::string miss = "axis 2 0.0135 rad from its target, limit 0.0020 rad";
    EXPECT_EQ(text(Cause::refused), "iiwa: the cabinet refused: joint velocity (201)");
    EXPECT_EQ(text(Cause::not_ready), "iiwa: not ready to move: " + miss);
    EXPECT_EQ(text(Cause::off_target), "iiwa: the motion ended with " + miss);
    EXPECT_EQ(text(Cause::stalled), "iiwa: the motion neither went on nor ended: " + miss);
    EXPECT_EQ(text(Cause::disconnected), "gone");
    end.error = -16;
    EXPECT_EQ(text(Cause::refused),
              "iiwa: the cabinet refused: joint velocity (201) (error -16: not possible in the "
              "present configuration)");
}

TEST(Miss, IsToldInItsUnit) {
    EXPECT_EQ(toString(Miss{Miss::Quantity::position, 0, 0.01, 0.001}),
              "the tool 0.0100 m from its target, limit 0.0010 m");
    EXPECT_EQ(toString(Miss{Miss::Quantity::rotation, 0, 0.1, 0.005}),
              "the tool's orientation 0.1000 rad from its target, limit 0.0050 rad");
}

// ---- force ----

TEST(FlangeForce, IsAFaultWhereTheCabinetDoesNotKnowIt) {
    device::ArmCore core{{"iiwa", std::vector<std::string>(kAxes, "A"), 10ms}};
    FlangeForce force(core, 1h);
    const auto now = std::chrono::steady_clock::now();
    CabinetState answer;
    answer.force = {1.0, 2.0, 3.0};
    answer.torque = {4.0, 5.0, 6.0};
    force.take(answer, now);
    EXPECT_EQ(force.sample().health, SafetyState::normal);
    EXPECT_EQ(force.sample().torque, answer.torque);
    const auto sequence = force.sample().sequence;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        auto unknown = answer;
        unknown.force[axis] = kNan;
        force.take(unknown, now);
        EXPECT_EQ(force.sample().health, SafetyState::fault) << axis;
        EXPECT_FALSE(force.tare());
        unknown = answer;
        unknown.torque[axis] = kNan;
        force.take(unknown, now);
        EXPECT_EQ(force.sample().health, SafetyState::fault) << axis;
    }
    EXPECT_EQ(force.sample().sequence, sequence + 6);
    force.take(answer, now - 2h);
    EXPECT_EQ(force.sample().health, SafetyState::disconnected);
    force.take(answer, now);
    ASSERT_TRUE(force.tare());
    EXPECT_EQ(force.sample().torque, (std::array{0.0, 0.0, 0.0}));
}

}  // namespace
}  // namespace metier::iiwa_driver
