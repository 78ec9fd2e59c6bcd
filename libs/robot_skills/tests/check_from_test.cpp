// Check of a move for an arm that stands elsewhere by then.
#include <gmock/gmock.h>

#include "bench.hpp"

namespace metier::robot_skills {
namespace {

using skill::ArmPositions;
using skill::CheckReport;
using skill::ValueMap;
using ::testing::HasSubstr;

const std::string kLine = "CartesianLinearMoveSkill";
const std::string kPtp = "JointPtpMoveSkill";

class CheckOfAMove : public ::testing::Test {
protected:
    CheckReport check(const std::string& skill, const ValueMap& values,
                      const ArmPositions& starts) {
        CheckReport answer{.reason = "no answer"};
        bench_.program(skill).check(
            bench_.caller(), {values, starts},
            [&](const Result<CheckReport>& report) { answer = report.value(); });
        return answer;
    }
    static std::vector<double> toList(const motion::JointVector& joints) {
        return {joints.begin(), joints.end()};
    }
    /// Home, with axis 1 turned by `angle` [rad].
    std::vector<double> turned(double angle) {
        auto place = toList(bench_.commanded());
        place[0] += angle;
        return place;
    }

    Bench bench_;
};

TEST_F(CheckOfAMove, BeginsWhereTheArmStandsThen) {
    const ValueMap target{{"TargetJointPosition", turned(1.0)}};
    const auto from_here = check(kPtp, target, {});
    const auto from_near = check(kPtp, target, {{"", turned(0.9)}});
    ASSERT_TRUE(from_here.possible && from_near.possible);
    EXPECT_LT(from_near.planned_duration, 0.9 * from_here.planned_duration);
    EXPECT_EQ(from_near.joint_path.front(), turned(0.9));
    EXPECT_EQ(from_here.joint_path.front(), toList(bench_.commanded()));
}

TEST_F(CheckOfAMove, ReportsWhereItEndsAndLeadsOnFromThere) {
    const auto first = check(kPtp, {{"TargetJointPosition", turned(1.0)}}, {});
    ASSERT_TRUE(first.ends_known);
    ASSERT_EQ(first.ends.size(), 1U);
    EXPECT_EQ(first.ends.at(""), turned(1.0));
    // One that is relative begins there, too.
    const ValueMap up{{"TargetPosition", skill::Frame{0, 0, 0.05}}, {"Relative", std::int32_t{1}}};
    const auto second = check(kLine, up, first.ends);
    ASSERT_TRUE(second.possible) << second.reason;
    const auto& kinematics = bench_.model().kinematics();
    const auto begin = kinematics.forward(*motion::JointVector::from(first.ends.at("")));
    const auto end = kinematics.forward(*motion::JointVector::from(second.ends.at("")));
    EXPECT_LT((end.translation - begin.translation - Eigen::Vector3d(0, 0, 0.05)).norm(), 1e-6);
}

TEST_F(CheckOfAMove, LooksAtTheStateOfTheArmOnlyIfTheMoveBeginsNow) {
    const ValueMap target{{"TargetJointPosition", turned(1.0)}};
    bench_.arm().protectiveStop("hit a table");
    bench_.step();
    const auto now = check(kPtp, target, {});
    EXPECT_FALSE(now.possible);
    EXPECT_THAT(now.reason, HasSubstr("hit a table"));
    EXPECT_EQ(now.code, "device_fault");
    EXPECT_TRUE(check(kPtp, target, {{"", turned(0.5)}}).possible);
}

TEST_F(CheckOfAMove, RefusesAPlaceThatIsNoneOfThisArm) {
    const ValueMap target{{"TargetJointPosition", turned(1.0)}};
    const auto short_one = check(kPtp, target, {{"", {1.0}}});
    EXPECT_EQ(short_one.reason, "StartJointPosition: 6 values expected, 1 given");
    EXPECT_EQ(short_one.code, "invalid_argument");
    EXPECT_FALSE(check(kPtp, target, {{"", std::vector<double>(6, std::nan(""))}}).possible);
    EXPECT_TRUE(check(kPtp, target, {{"opc.tcp://else", {1.0}}}).possible) << "another arm";
}

TEST_F(CheckOfAMove, ReportsTheKindOfARefusal) {
    const ValueMap far{{"TargetPosition", skill::Frame{5, 0, 0}}};
    const auto report = check(kLine, far, {{"", turned(0.5)}});
    EXPECT_FALSE(report.possible);
    EXPECT_EQ(report.code, "unreachable");
    EXPECT_THAT(report.reason, HasSubstr("reach"));
}

}  // namespace
}  // namespace metier::robot_skills
