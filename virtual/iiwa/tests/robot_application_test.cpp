#include "robot_application.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <initializer_list>
#include <limits>

#include "iiwa_model.hpp"
#include "metier/motion/frame.hpp"

namespace metier::virtual_iiwa {
namespace {

using motion::JointVector;
using Answer = RobotApplication::Answer;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class ApplicationTest : public ::testing::Test {
protected:
    Answer send(double code, std::initializer_list<double> arguments = {}) {
        Command command;
        command.code = code;
        std::copy(arguments.begin(), arguments.end(), command.arguments.begin());
        return application_.execute(command);
    }
    double status(double code, std::initializer_list<double> arguments = {}) {
        EXPECT_EQ(send(code, arguments), Answer::at_once);
        return element(state_index::kStatus);
    }
    double element(std::size_t index) const { return application_.state()[index]; }
    double error() const { return element(state_index::kError); }
    void cycle() { application_.step(cabinet_.arm.step()); }
    void cycles(int count) {
        while (count-- > 0) {
            cycle();
        }
    }
    void untilStanding() {
        for (int left = 20'000; left > 0 && cabinet_.arm.moving(); --left) {
            cycle();
        }
        EXPECT_FALSE(cabinet_.arm.moving());
    }
    double home(std::size_t axis) const { return iiwaModel().home()[axis]; }

    Cabinet cabinet_{.arm = Arm(iiwaModel(), iiwaModel().home()), .torque_noise = JointVector(7)};
    RobotApplication application_{cabinet_};
};

TEST_F(ApplicationTest, OnlyTellsItsStateOnCommandZero) {
    EXPECT_EQ(status(0), 0.0);
    EXPECT_EQ(error(), -10.0);
    EXPECT_EQ(element(state_index::kReady), 1.0);
    EXPECT_EQ(element(state_index::kMoving), 0.0);
    for (std::size_t axis = 0; axis < 7; ++axis) {
        EXPECT_EQ(element(state_index::kJointPosition + axis), home(axis));
    }
    const auto frame = motion::toFrame(iiwaModel().kinematics().forward(iiwaModel().home()));
    EXPECT_NEAR(element(state_index::kPosition), 1000 * frame.x, 1e-9);
    EXPECT_NEAR(element(state_index::kPosition + 2), 1000 * frame.z, 1e-9);
    EXPECT_NEAR(element(state_index::kOrientation), frame.c, 1e-9);
    EXPECT_NEAR(element(state_index::kOrientation + 1), frame.b, 1e-9);
    EXPECT_NEAR(element(state_index::kOrientation + 2), frame.a, 1e-9);
}

TEST_F(ApplicationTest, EndsOnANegativeNumberAndRefusesWhatItDoesNotKnow) {
    EXPECT_EQ(send(-1), Answer::application_ends);
    EXPECT_EQ(status(999), 0.0);
    EXPECT_EQ(status(99.6), 0.0);
    EXPECT_EQ(status(kNaN), 0.0);
    EXPECT_EQ(error(), -10.0);
}

TEST_F(ApplicationTest, MovesJoints) {
    EXPECT_EQ(status(201, {0.5}), 1.0);
    EXPECT_EQ(status(302, {31}), 1.0);
    EXPECT_EQ(status(303, {21}), 1.0);
    EXPECT_EQ(status(102, {0.3, home(1), home(2), home(3), home(4), home(5), home(6)}), 1.0);
    EXPECT_EQ(element(state_index::kMoving), 1.0);
    cycles(100);
    EXPECT_GT(element(state_index::kJointVelocity), 0.0);
    untilStanding();
    EXPECT_NEAR(element(state_index::kJointPosition), 0.3, 1e-12);
    EXPECT_EQ(element(state_index::kMoving), 0.0);
    EXPECT_EQ(error(), -10.0);
}

TEST_F(ApplicationTest, KeepsJointsThatAreNoNumberOrBeyondTheirLimits) {
    EXPECT_EQ(status(102, {0.3, kNaN, 99.0, home(3), home(4), home(5), home(6)}), 1.0);
    untilStanding();
    EXPECT_NEAR(element(state_index::kJointPosition), 0.3, 1e-12);
    EXPECT_EQ(element(state_index::kJointPosition + 1), home(1));
    EXPECT_EQ(element(state_index::kJointPosition + 2), home(2));
    EXPECT_EQ(error(), -10.0);
}

TEST_F(ApplicationTest, MovesToAPoseAndKeepsWhatIsNoNumber) {
    const double x = element(state_index::kPosition);
    const double z = element(state_index::kPosition + 2);
    for (const double type : {21.0, 22.0}) {
        EXPECT_EQ(status(303, {type}), 1.0);
        EXPECT_EQ(status(103, {kNaN, 50.0 + type, kNaN, kNaN, kNaN, kNaN}), 1.0);
        untilStanding();
        EXPECT_NEAR(element(state_index::kPosition), x, 1e-3);
        EXPECT_NEAR(element(state_index::kPosition + 1), 50.0 + type, 1e-3);
        EXPECT_NEAR(element(state_index::kPosition + 2), z, 1e-3);
    }
}

TEST_F(ApplicationTest, CannotMoveToAPoseAlongOtherTypes) {
    for (const double type : {23.0, 24.0}) {
        EXPECT_EQ(status(303, {type}), 1.0);
        EXPECT_EQ(status(103, {kNaN, 50.0, kNaN, kNaN, kNaN, kNaN}), 0.0);
    }
    EXPECT_EQ(error(), -10.0);
}

TEST_F(ApplicationTest, MovesAroundACircle) {
    const double x = element(state_index::kPosition);
    const double y = element(state_index::kPosition + 1);
    const double z = element(state_index::kPosition + 2);
    EXPECT_EQ(status(104, {x + 50, y + 50, z, x, y + 100, z}), 1.0);
    untilStanding();
    EXPECT_NEAR(element(state_index::kPosition), x, 1e-3);
    EXPECT_NEAR(element(state_index::kPosition + 1), y + 100, 1e-3);
    EXPECT_EQ(status(302, {32}), 1.0);
    EXPECT_EQ(status(104, {x + 50, y + 50, z, x, y, z}), 0.0);
    EXPECT_EQ(error(), -16.0);
}

TEST_F(ApplicationTest, KeepsAnErrorForEver) {
    EXPECT_EQ(status(201, {1.5}), 0.0);
    EXPECT_EQ(error(), -11.0);
    EXPECT_EQ(status(201, {0.5}), 1.0);
    EXPECT_EQ(error(), -11.0);
}

TEST_F(ApplicationTest, RefusesValuesThatAreNone) {
    EXPECT_EQ(status(201, {-0.1}), 0.0);
    EXPECT_EQ(status(203, {kNaN}), 0.0);
    EXPECT_EQ(status(204, {0.0}), 0.0);
    EXPECT_EQ(status(204, {250.0}), 1.0);
    EXPECT_EQ(status(302, {33}), 0.0);
    EXPECT_EQ(status(303, {25}), 0.0);
    EXPECT_EQ(status(305, {51.5}), 0.0);
    EXPECT_EQ(status(211, {-1, 1, 1, 1, 1, 1}), 0.0);
    EXPECT_EQ(status(211, {1, 1, 1, 1, 0, 1}), 0.0);
    EXPECT_EQ(status(212, {0, 5, 5}), 0.0);
    EXPECT_EQ(error(), -11.0);
}

TEST_F(ApplicationTest, EndsOnATorqueConditionOfAJointThatIsNone) {
    EXPECT_EQ(send(212, {7, -1, 1}), Answer::application_ends);
    EXPECT_EQ(send(212, {-1, -1, 1}), Answer::application_ends);
    EXPECT_EQ(send(212, {kNaN, -1, 1}), Answer::at_once) << "rounded to 0";
}

TEST_F(ApplicationTest, RoundsCodesAndAxes) {
    EXPECT_EQ(status(201.4, {0.5}), 1.0);
    EXPECT_EQ(send(212, {6.4, -1, 1}), Answer::at_once);
    EXPECT_EQ(send(212, {6.5, -1, 1}), Answer::application_ends);
}

TEST_F(ApplicationTest, SaysNothingOfAWayToTellTheStateThatItDoesNotKnow) {
    EXPECT_EQ(status(301, {13}), 0.0);
    EXPECT_EQ(error(), -10.0);
}

TEST_F(ApplicationTest, KeepsWhatWasSetOfAnImpedanceThatIsOutOfRange) {
    EXPECT_EQ(status(221, {2000, 2000, 2000, 200, 200, 200, 100}), 1.0);
    EXPECT_EQ(status(228, {1, 1, 1, 1, 1, 1, 0}), 1.0);
    EXPECT_EQ(status(241, {1, 5, 10, 500}), 1.0);
    EXPECT_EQ(application_.impedance().size(), 3U);
    EXPECT_EQ(status(221, {5001, 1, 0, 0, 301, 0, 0}), 1.0);
    EXPECT_THAT(application_.impedance().at(221), ::testing::ElementsAre(2000, 1, 0, 0, 200, 0, 0));
    EXPECT_EQ(status(226, {-1, -1, 10, -1, -1, -1, -1}), 1.0);
    EXPECT_THAT(application_.impedance().at(226),
                ::testing::ElementsAre(1e6, 1e6, 10, 1e6, 1e6, 1e6, -1));
    EXPECT_EQ(error(), -10.0);
}

TEST_F(ApplicationTest, FollowsSetPointsOnTheServoInterface) {
    EXPECT_EQ(status(302, {32}), 1.0);
    for (int i = 1; i <= 50; ++i) {
        EXPECT_EQ(status(102, {0.004 * i, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0);
        cycles(10);
    }
    cycles(1000);
    EXPECT_NEAR(element(state_index::kJointPosition), 0.2, 1e-9);
    EXPECT_EQ(element(state_index::kMoving), 1.0);
    EXPECT_EQ(status(101), 1.0);
    untilStanding();
}

TEST_F(ApplicationTest, FollowsPosesOnTheServoInterface) {
    EXPECT_EQ(status(302, {32}), 1.0);
    for (const double type : {21.0, 22.0}) {
        EXPECT_EQ(status(303, {type}), 1.0);
        EXPECT_EQ(status(103, {kNaN, 30.0 + type, kNaN, kNaN, kNaN, kNaN}), 1.0);
        cycles(3000);
        EXPECT_NEAR(element(state_index::kPosition + 1), 30.0 + type, 1e-3);
    }
}

TEST_F(ApplicationTest, NeedsAsynchronousExecutionForTheServoInterface) {
    EXPECT_EQ(status(302, {32}), 1.0);
    EXPECT_EQ(status(305, {52}), 1.0);
    EXPECT_EQ(status(102, {0.1, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 0.0);
    EXPECT_EQ(error(), -16.0);
}

TEST_F(ApplicationTest, AnswersASynchronousMoveAtItsEnd) {
    EXPECT_EQ(status(305, {52}), 1.0);
    EXPECT_EQ(send(102, {0.1, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), Answer::after_motion);
    EXPECT_TRUE(application_.waiting());
    untilStanding();
    EXPECT_FALSE(application_.waiting());
    EXPECT_EQ(element(state_index::kStatus), 1.0);
}

TEST_F(ApplicationTest, TellsFailuresByTheKindOfExecution) {
    EXPECT_EQ(status(103, {5000, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0);
    untilStanding();
    EXPECT_EQ(error(), -14.0);
    EXPECT_EQ(status(305, {52}), 1.0);
    EXPECT_EQ(send(103, {5000, kNaN, kNaN, kNaN, kNaN, kNaN}), Answer::after_motion);
    untilStanding();
    EXPECT_EQ(error(), -13.0);
    EXPECT_EQ(element(state_index::kStatus), 0.0);
}

TEST_F(ApplicationTest, RefusesMovesWhileNotReady) {
    cabinet_.emergency_stop = true;
    EXPECT_EQ(status(102, {0.1, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 0.0);
    EXPECT_EQ(error(), -10.0);
    EXPECT_EQ(element(state_index::kReady), 0.0);
}

TEST_F(ApplicationTest, StopsAtAForceAndTellsSoUntilTheNextMotion) {
    EXPECT_EQ(status(211, {kNaN, kNaN, 10, 5, 5, 5}), 1.0);
    EXPECT_EQ(status(102, {1.0, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0);
    cabinet_.wrench.force = {50.0, 0.0, -9.0};
    cycles(300);
    EXPECT_EQ(element(state_index::kConditionFired), 0.0);
    cabinet_.wrench.force.z() = -11.0;
    cycle();
    EXPECT_EQ(element(state_index::kConditionFired), 1.0);
    untilStanding();
    EXPECT_LT(element(state_index::kJointPosition), 0.9);
    EXPECT_EQ(element(state_index::kForce + 2), -11.0);
    EXPECT_EQ(error(), -10.0);
    cabinet_.wrench = {};
    EXPECT_EQ(status(102, {1.0, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0);
    EXPECT_EQ(element(state_index::kConditionFired), 0.0);
    untilStanding();
    EXPECT_NEAR(element(state_index::kJointPosition), 1.0, 1e-12);
}

TEST_F(ApplicationTest, ForgetsThatAConditionStoppedAMotionOnceItIsToldToStopMotions) {
    for (const double code : {101.0, 211.0, 303.0}) {
        EXPECT_EQ(status(211, {10, kNaN, kNaN, 5, 5, 5}), 1.0);
        EXPECT_EQ(status(102, {1.0, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0);
        cabinet_.wrench.force = {11.0, 0.0, 0.0};
        cycle();
        EXPECT_EQ(element(state_index::kConditionFired), 1.0);
        untilStanding();
        EXPECT_EQ(status(code, {22, 22, 22, 1, 1, 1}), 1.0);
        EXPECT_EQ(element(state_index::kConditionFired), 0.0) << code;
        cabinet_.wrench = {};
    }
}

TEST_F(ApplicationTest, SwitchesAConditionOffThatItThenRefuses) {
    EXPECT_EQ(status(211, {10, 10, 10, 5, 5, 5}), 1.0);
    EXPECT_EQ(status(211, {kNaN, -1, 20, -5, 5, 5}), 0.0);
    EXPECT_EQ(error(), -11.0);
    EXPECT_EQ(status(212, {0, -5, 5}), 1.0);
    EXPECT_EQ(status(212, {0, 5, -5}), 0.0);
    EXPECT_EQ(status(102, {1.0, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0);
    cabinet_.wrench.force = {15.0, 15.0, 15.0};
    cycle();
    EXPECT_EQ(element(state_index::kConditionFired), 0.0);
    cabinet_.wrench.force = {15.0, 15.0, 21.0};
    cycle();
    EXPECT_EQ(element(state_index::kConditionFired), 1.0) << "the third axis was taken";
    untilStanding();
}

TEST_F(ApplicationTest, StopsAtATorqueOfAnAxis) {
    EXPECT_EQ(status(212, {0, -5, 5}), 1.0);
    EXPECT_EQ(status(102, {1.0, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0);
    cycles(100);
    EXPECT_EQ(element(state_index::kConditionFired), 0.0);
    cabinet_.wrench.force = {0.0, 100.0, 0.0};
    cycle();
    EXPECT_EQ(element(state_index::kConditionFired), 1.0);
    EXPECT_GT(std::abs(element(state_index::kJointTorque)), 5.0);
    EXPECT_EQ(status(212, {0, kNaN, 5}), 1.0);
    EXPECT_EQ(status(102, {0.1, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0);
    untilStanding();
    EXPECT_NEAR(element(state_index::kJointPosition), 0.1, 1e-12);
}

TEST_F(ApplicationTest, FeelsAForceOnItsAxesByTheLever) {
    cabinet_.wrench.force = {0.0, 0.0, 10.0};
    const auto flange = iiwaModel().kinematics().forward(iiwaModel().home());
    const Eigen::Vector3d force = flange.rotation * cabinet_.wrench.force;
    const double torque = flange.translation.cross(force).z();
    EXPECT_NEAR(element(state_index::kJointTorque), torque, 1e-9);
}

TEST_F(ApplicationTest, CancelsAMotionBySettings) {
    EXPECT_EQ(status(102, {1.0, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0);
    cycles(200);
    EXPECT_EQ(status(303, {22}), 1.0);
    untilStanding();
    EXPECT_LT(element(state_index::kJointPosition), 0.9);
    EXPECT_EQ(error(), -10.0);
    EXPECT_EQ(status(102, {1.0, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}), 1.0);
    cycles(50);
    EXPECT_EQ(status(201, {0.5}), 1.0);
    untilStanding();
    EXPECT_NEAR(element(state_index::kJointPosition), 1.0, 1e-12);
}

TEST_F(ApplicationTest, NeverAnswersAgainInThePeriodicalMode) {
    EXPECT_EQ(send(301, {12}), Answer::then_no_more);
}

TEST_F(ApplicationTest, AttachesToolsThatItHas) {
    EXPECT_EQ(status(400, {-1}), 1.0);
    EXPECT_EQ(status(400, {99}), 0.0);
    EXPECT_EQ(error(), -11.0);
}

}  // namespace
}  // namespace metier::virtual_iiwa
