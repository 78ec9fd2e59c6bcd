#include "arm.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "iiwa_model.hpp"
#include "metier/motion/rotation.hpp"

namespace metier::virtual_iiwa {
namespace {

using motion::JointVector;
using motion::Pose;

class ArmTest : public ::testing::Test {
protected:
    Pose pose() const { return model_.kinematics().forward(arm_.position()); }
    MovingFrame flange() const { return {&model_, {}}; }
    Pose shifted(const Eigen::Vector3d& way) const {
        auto target = pose();
        target.translation += way;
        return target;
    }
    void ptp(const JointVector& target) {
        arm_.move([this, target](const JointVector& start) {
            return planPtp(model_, start, target, limits_);
        });
    }
    void line(const Pose& target) {
        arm_.move([this, target](const JointVector& start) {
            return planLinear(flange(), start, target, limits_);
        });
    }
    /// Until the motion ended, but not for ever; checks that no axis is too fast on the way.
    std::optional<Arm::End> run(const std::function<void()>& each_cycle = {}, int cycles = 20'000) {
        while (cycles-- > 0) {
            const auto before = arm_.position();
            const auto end = arm_.step();
            ++cycles_;
            for (std::size_t axis = 0; axis < before.size(); ++axis) {
                const double speed = (arm_.position()[axis] - before[axis]) / kCycleSeconds;
                EXPECT_LE(std::abs(speed), 1.06 * model_.limits(axis).velocity) << "axis " << axis;
                const double change = std::abs(speed - speed_[axis]) / kCycleSeconds;
                largest_acceleration_ = std::max(largest_acceleration_, change);
                speed_[axis] = speed;
            }
            if (each_cycle) {
                each_cycle();
            }
            if (end) {
                return end;
            }
        }
        return std::nullopt;
    }

    const motion::RobotModel& model_ = iiwaModel();
    Arm arm_{model_, model_.home()};
    MotionLimits limits_;
    int cycles_ = 0;
    JointVector speed_ = JointVector(7);
    double largest_acceleration_ = 0.0;  // [rad/s2]
};

TEST_F(ArmTest, MovesAllAxesTogether) {
    auto target = model_.home();
    target[0] += 1.0;
    target[3] += 0.5;
    ptp(target);
    EXPECT_TRUE(arm_.moving());
    const auto start = model_.home();
    EXPECT_EQ(run([&] {
                  EXPECT_NEAR(arm_.position()[0] - start[0], 2.0 * (arm_.position()[3] - start[3]),
                              1e-9);
              }),
              Arm::End::done);
    EXPECT_EQ(arm_.position(), target);
    EXPECT_FALSE(arm_.moving());
    // 1 rad at 98 deg/s and twice the model's 5 rad/s2, with a little for the jerk.
    const double quickest = 1.0 / 1.7104 + 1.7104 / 10.0;
    EXPECT_NEAR(cycles_ * kCycleSeconds, quickest, 0.05);
    EXPECT_LT(largest_acceleration_, 10.1);
}

TEST_F(ArmTest, IsSlowerWithSmallerShares) {
    limits_.joint_velocity = 0.1;
    auto target = model_.home();
    target[0] += 0.5;
    ptp(target);
    double fastest = 0.0;
    EXPECT_EQ(run([&] { fastest = std::max(fastest, arm_.velocity()[0]); }), Arm::End::done);
    EXPECT_NEAR(fastest, 0.1 * model_.limits(0).velocity, 1e-6);
}

TEST_F(ArmTest, RunsAlongALineAtItsSpeed) {
    limits_.velocity = 0.1;
    limits_.acceleration = 1.0;
    const auto from = pose();
    const auto to = shifted({0.0, 0.2, -0.1});
    const Eigen::Vector3d direction = (to.translation - from.translation).normalized();
    line(to);
    auto last = from.translation;
    double fastest = 0.0;
    EXPECT_EQ(run([&] {
                  const auto now = pose();
                  const Eigen::Vector3d way = now.translation - from.translation;
                  EXPECT_LT((way - way.dot(direction) * direction).norm(), 1e-6);
                  EXPECT_LT(motion::rotationAngleBetween(now.rotation, from.rotation), 1e-6);
                  fastest = std::max(fastest, (now.translation - last).norm() / kCycleSeconds);
                  last = now.translation;
              }),
              Arm::End::done);
    EXPECT_LT(motion::distanceBetween(pose(), to), 1e-6);
    EXPECT_NEAR(fastest, 0.1, 1e-3);
}

TEST_F(ArmTest, TurnsAlongALineTheShortWay) {
    auto to = shifted({0.05, 0.0, 0.0});
    to.rotation = Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitX()) * to.rotation;
    line(to);
    EXPECT_EQ(run(), Arm::End::done);
    EXPECT_LT(motion::rotationAngleBetween(pose().rotation, to.rotation), 1e-6);
}

TEST_F(ArmTest, SlowsALineDownWhereAnAxisNeedsIt) {
    limits_.velocity = 10.0;
    limits_.acceleration = 100.0;
    line(shifted({0.0, 0.4, 0.0}));
    EXPECT_EQ(run(), Arm::End::done);  // run() checks the axes' speeds
    EXPECT_LT(largest_acceleration_, 15.0);
}

TEST_F(ArmTest, FailsWhereItCannotGet) {
    line(shifted({2.0, 0.0, 0.0}));
    EXPECT_EQ(run(), Arm::End::failed);
    EXPECT_EQ(arm_.position(), model_.home());
    arm_.move([this](const JointVector& start) {
        return planPtp(flange(), start, shifted({0.0, 0.0, 3.0}), limits_);
    });
    EXPECT_EQ(run(), Arm::End::failed);
}

TEST_F(ArmTest, RunsAroundACircle) {
    const auto from = pose();
    const double radius = 0.1;
    const Eigen::Vector3d centre = from.translation + Eigen::Vector3d(0.0, radius, 0.0);
    const CirclePoints points{centre + Eigen::Vector3d(radius, 0.0, 0.0),
                              centre + Eigen::Vector3d(0.0, radius, 0.0)};
    arm_.move([&, points](const JointVector& start) {
        return planCircle(flange(), start, points, limits_);
    });
    double farthest = 0.0;
    EXPECT_EQ(run([&] {
                  EXPECT_NEAR((pose().translation - centre).norm(), radius, 1e-6);
                  farthest = std::max(farthest, pose().translation.x() - centre.x());
              }),
              Arm::End::done);
    EXPECT_NEAR(farthest, radius, 1e-4);
    EXPECT_LT((pose().translation - points.end).norm(), 1e-6);
    arm_.move([&](const JointVector& start) {
        const auto at = pose().translation;
        return planCircle(flange(), start,
                          {at + Eigen::Vector3d::UnitX(), at - Eigen::Vector3d::UnitX()}, limits_);
    });
    EXPECT_EQ(run(), Arm::End::failed);
}

TEST_F(ArmTest, BrakesOnItsPath) {
    const auto from = pose();
    const auto to = shifted({0.0, 0.3, 0.0});
    line(to);
    int left = 300;
    EXPECT_EQ(run([&] {
                  EXPECT_LT(std::abs(pose().translation.x() - from.translation.x()), 1e-6);
                  if (--left == 0) {
                      arm_.brake(Arm::End::cancelled);
                  }
              }),
              Arm::End::cancelled);
    EXPECT_FALSE(arm_.moving());
    EXPECT_GT(motion::distanceBetween(pose(), to), 0.05);
    EXPECT_LT(largest_acceleration_, 15.0);
}

TEST_F(ArmTest, ReplacesAMotionByAnother) {
    auto first = model_.home();
    first[0] += 1.0;
    auto second = model_.home();
    second[1] += 0.2;
    ptp(first);
    int left = 200;
    EXPECT_EQ(run([&] {
                  if (--left == 0) {
                      ptp(second);
                  }
              }),
              Arm::End::done);
    EXPECT_EQ(arm_.position(), second);
    EXPECT_LT(largest_acceleration_, 10.1);
}

TEST_F(ArmTest, FollowsJointSetPointsThatChangeOnTheWay) {
    auto target = model_.home();
    limits_.joint_velocity = 0.5;
    for (int i = 0; i < 100; ++i) {
        target[0] += 0.005;
        arm_.servoTo(target, limits_);
        run({}, 10);
        EXPECT_TRUE(arm_.moving());
    }
    run({}, 1000);
    EXPECT_NEAR(arm_.position()[0], target[0], 1e-9);
    EXPECT_TRUE(arm_.moving()) << "a servo motion waits for the next set-point";
    EXPECT_LT(largest_acceleration_, 10.1);
    arm_.brake(Arm::End::cancelled);
    EXPECT_EQ(run(), Arm::End::cancelled);
}

TEST_F(ArmTest, EndsAServoMotionThatGetsNoSetPoints) {
    arm_.servoTo(model_.home(), limits_);
    EXPECT_EQ(run({}, 301'000), Arm::End::done);
    EXPECT_NEAR(cycles_ * kCycleSeconds, 300.0, 0.1);
}

TEST_F(ArmTest, FollowsPoses) {
    auto to = shifted({0.05, -0.05, 0.0});
    to.rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) * to.rotation;
    arm_.servoTo(flange(), to, limits_);
    run({}, 3000);
    EXPECT_LT(motion::distanceBetween(pose(), to), 1e-6);
    EXPECT_LT(motion::rotationAngleBetween(pose().rotation, to.rotation), 1e-6);
    arm_.servoTo(flange(), shifted({3.0, 0.0, 0.0}), limits_);
    EXPECT_EQ(run(), Arm::End::failed);
}

TEST_F(ArmTest, BrakesBeforeAServoMotionBegins) {
    auto target = model_.home();
    target[0] += 1.0;
    ptp(target);
    run({}, 300);
    arm_.servoTo(model_.home(), limits_);
    run({}, 3000);
    EXPECT_NEAR(arm_.position()[0], model_.home()[0], 1e-9);
    EXPECT_LT(largest_acceleration_, 10.1);
}

}  // namespace
}  // namespace metier::virtual_iiwa
