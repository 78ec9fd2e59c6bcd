#include "metier/server/kinematics_conversion.hpp"

#include <gmock/gmock.h>

namespace metier::server {
namespace {

using motion::JointVector;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class RobotOfAClient : public ::testing::TestWithParam<const char*> {
protected:
    const motion::RobotModel robot_ =
        motion::RobotModel::load(std::string(METIER_MODELS_DIR "/") + GetParam()).value();
    const opcua_skill::KinematicsData published_ = toKinematicsData(robot_);
    const std::vector<double> home_{robot_.home().begin(), robot_.home().end()};
};

TEST_P(RobotOfAClient, HasThePosesAndReachOfTheServers) {
    auto chain = toChain(published_, home_);
    ASSERT_TRUE(chain) << chain.error().message;
    const auto read = motion::RobotModel::fromChain(std::move(*chain));
    ASSERT_TRUE(read) << read.error().message;
    for (const double share : {0.0, 0.3, 0.9}) {
        std::vector<double> position;
        for (std::size_t axis = 0; axis < robot_.axisCount(); ++axis) {
            const auto& limits = robot_.chain().joints[axis].limits;
            position.push_back(limits.lower + share * (limits.upper - limits.lower));
        }
        const auto joints = JointVector::from(position).value();
        const auto there = robot_.kinematics().forward(joints);
        const auto here = read->kinematics().forward(joints);
        EXPECT_LT(motion::distanceBetween(there, here), 1e-9);
        EXPECT_LT(there.rotation.angularDistance(here.rotation), 1e-9);
    }
    EXPECT_NEAR(read->kinematics().reach(), robot_.kinematics().reach(), 1e-9);
}

TEST_P(RobotOfAClient, HasTheLimitsOfTheServers) {
    const auto chain = toChain(published_, home_).value();
    for (std::size_t axis = 0; axis < robot_.axisCount(); ++axis) {
        const auto& there = robot_.chain().joints[axis].limits;
        const auto& here = chain.joints[axis].limits;
        EXPECT_EQ(here.lower, there.lower);
        EXPECT_EQ(here.upper, there.upper);
        EXPECT_EQ(here.velocity, there.velocity);
        EXPECT_EQ(here.acceleration, there.acceleration);
        EXPECT_EQ(here.jerk, there.jerk);
    }
    const auto& there = robot_.chain().cartesian_limits;
    const auto& here = chain.cartesian_limits;
    EXPECT_EQ(here.velocity, there.velocity);
    EXPECT_EQ(here.acceleration, there.acceleration);
    EXPECT_EQ(here.jerk, there.jerk);
    EXPECT_EQ(here.angular_velocity, there.angular_velocity);
    EXPECT_EQ(here.angular_acceleration, there.angular_acceleration);
    EXPECT_EQ(here.angular_jerk, there.angular_jerk);
    EXPECT_EQ(chain.cycle_time, robot_.chain().cycle_time);
}

TEST_P(RobotOfAClient, IsAtHomeWhereItIsNow) {
    auto now = home_;
    now[0] += 0.1;
    const auto chain = toChain(published_, now).value();
    EXPECT_EQ(chain.home[0], home_[0] + 0.1);
}

INSTANTIATE_TEST_SUITE_P(Of, RobotOfAClient,
                         ::testing::Values("ur5.toml", "iiwa7.toml", "edo.toml"));

TEST(PublishedKinematics, NameTheFlangeAndThenTheTools) {
    const auto robot = motion::RobotModel::load(METIER_MODELS_DIR "/ur5.toml").value();
    auto chain = robot.chain();
    chain.tools.resize(1);
    chain.tools[0].name = "pen";
    const auto data = toKinematicsData(robot.withChain(std::move(chain)).value());
    EXPECT_THAT(data.tool_frames, ElementsAre("flange", "pen"));
}

TEST(PublishedKinematics, OfMoreAxesThanMotionPlansForAreRefused) {
    opcua_skill::KinematicsData data;
    data.joint_axes.resize(motion::kMaxAxes + 1);
    const auto chain = toChain(data, std::vector<double>(motion::kMaxAxes + 1, 0.0));
    ASSERT_FALSE(chain);
    EXPECT_EQ(chain.error().code, Errc::not_supported);
    EXPECT_THAT(chain.error().message, HasSubstr("an arm of "));
}

}  // namespace
}  // namespace metier::server
