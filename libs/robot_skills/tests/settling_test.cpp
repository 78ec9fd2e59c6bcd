#include "moves/settling.hpp"

#include <gtest/gtest.h>

namespace metier::robot_skills {
namespace {

using Status = Settling::Status;

constexpr double kCycle = 0.01;  // s

/// An arm of one axis whose last set-point is 0.
class Arm {
public:
    /// The time until `settling` has its answer, 20 s at most [s].
    /// \param position of the arm at a time, and whether it stands
    template <typename Motion>
    double timeUntilAnswer(Motion motion) {
        device::JointArray target(1);
        double time = 0.0;
        do {
            time += kCycle;
            device::ArmState state;
            state.position = device::JointArray(1);
            const auto [position, stands] = motion(time);
            state.position[0] = position;
            state.standstill = stands;
            answer = settling.take(state, target, kCycle);
        } while (answer == Status::waiting && time < 20.0);
        return time;
    }

    Settling settling;
    Status answer = Status::waiting;
};

struct Seen {
    double position;
    bool stands;
};

TEST(Settling, EndsWhereTheArmStandsAtItsSetPoint) {
    Arm arm;
    EXPECT_NEAR(arm.timeUntilAnswer([](double time) {
        return Seen{0.0005, time > 0.1};
    }),
                0.1, 2 * kCycle);
    EXPECT_EQ(arm.answer, Status::arrived);
}

TEST(Settling, WaitsForAnArmThatIsLateButMoves) {
    Arm arm;
    arm.timeUntilAnswer([](double time) {
        return time < 4.0 ? Seen{0.02, false} : Seen{0.0, true};
    });
    EXPECT_EQ(arm.answer, Status::arrived);
}

TEST(Settling, WaitsThroughAPauseOfTheNews) {
    Arm arm;
    arm.timeUntilAnswer([](double time) {
        return time < 1.5 ? Seen{0.02, true} : Seen{time < 2.0 ? 0.01 : 0.0, time > 2.0};
    });
    EXPECT_EQ(arm.answer, Status::arrived);
}

TEST(Settling, GivesUpAnArmThatRestsElsewhereAfterTwoSeconds) {
    Arm arm;
    EXPECT_NEAR(arm.timeUntilAnswer([](double) { return Seen{0.002, true}; }), 2.0, 2 * kCycle);
    EXPECT_EQ(arm.answer, Status::off_target);
}

TEST(Settling, GivesUpAnArmThatNeverArrivesAfterTen) {
    Arm arm;
    EXPECT_NEAR(arm.timeUntilAnswer([](double) { return Seen{0.002, false}; }), 10.0, 2 * kCycle);
    EXPECT_EQ(arm.answer, Status::off_target);
}

TEST(Settling, BeginsAnewForTheNextMotion) {
    Arm arm;
    arm.timeUntilAnswer([](double) { return Seen{0.002, true}; });
    arm.settling.restart();
    EXPECT_NEAR(arm.timeUntilAnswer([](double) { return Seen{0.002, true}; }), 2.0, 2 * kCycle);
}

TEST(Settling, TakesAnArmForArrivedWithinAMilliradian) {
    for (const auto& [off, status] :
         {std::pair(0.00099, Status::arrived), std::pair(0.00101, Status::waiting)}) {
        Settling settling;
        device::ArmState state;
        state.position = device::JointArray(1);
        state.position[0] = off;
        state.standstill = true;
        EXPECT_EQ(settling.take(state, device::JointArray(1), kCycle), Status::waiting)
            << "it may show the arm before it has begun";
        EXPECT_EQ(settling.take(state, device::JointArray(1), kCycle), status) << off;
    }
}

TEST(Settling, CountsRestAnewOnceTheArmMoves) {
    Arm arm;
    const double answered = arm.timeUntilAnswer([](double time) {
        return Seen{0.02, !(time > 1.5 && time < 1.6)};
    });
    EXPECT_NEAR(answered, 3.6, 3 * kCycle);
    EXPECT_EQ(arm.answer, Status::off_target);
}

}  // namespace
}  // namespace metier::robot_skills
