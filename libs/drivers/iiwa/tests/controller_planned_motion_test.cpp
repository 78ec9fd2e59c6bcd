#include <gmock/gmock.h>

#include <atomic>

#include "arm_bench.hpp"
#include "controller_planned_run.hpp"
#include "metier/motion/frame.hpp"

namespace metier::iiwa_driver {
namespace {

using device::ControllerPlannedMotion;
using device::MotionOutcome;
using device::SafetyState;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kNear = 2e-3;

class PlannedMoves : public ::testing::Test {
protected:
    PlannedMoves() { EXPECT_TRUE(bench.ready()); }

    /// The commands after those of the beginning.
    std::vector<int> codesSince(std::size_t count) {
        auto codes = bench.cabinet->codes();
        codes.erase(codes.begin(), codes.begin() + static_cast<std::ptrdiff_t>(count));
        return codes;
    }
    Result<MotionOutcome> run(const ControllerPlannedMotion& motion) {
        Outcome outcome;
        METIER_TRY(bench.arm->move(motion, outcome.taker()));
        EXPECT_TRUE(until([&] { return outcome.told(); }));
        EXPECT_EQ(outcome.count(), 1);
        return outcome.get();
    }
    /// To where the flange is at `first_axis`, on a line.
    ControllerPlannedMotion line(double first_axis) {
        const auto joints = ArmBench::toJoints(first_axis).target_joints;
        ControllerPlannedMotion motion;
        motion.path = ControllerPlannedMotion::Path::line;
        motion.target_flange = motion::toFrame(
            bench.model.kinematics().forward(motion::JointVector::from(joints.values()).value()));
        return motion;
    }

    ArmBench bench;
};

TEST_F(PlannedMoves, TheCabinetIsToldHowToExecuteBeforeAnythingElse) {
    EXPECT_THAT(bench.cabinet->codes(), ElementsAre(305, 302, 304));
    EXPECT_EQ(bench.cabinet->commands()[0][1], 51);
    EXPECT_EQ(bench.cabinet->commands()[1][1], 31);
    EXPECT_EQ(bench.cabinet->commands()[2][1], 41);
}

TEST_F(PlannedMoves, AJointMoveEndsAtItsTarget) {
    auto motion = ArmBench::toJoints(0.4);
    motion.velocity_share = 0.5;
    motion.acceleration_share = 0.25;
    const auto before = bench.cabinet->codes().size();
    const auto outcome = run(motion);
    ASSERT_TRUE(outcome) << outcome.error().message;
    EXPECT_EQ(outcome->end, MotionOutcome::End::at_target);
    EXPECT_NEAR(bench.cabinet->position()[0], 0.4, kNear);
    EXPECT_THAT(codesSince(before), ElementsAre(201, 202, 211, 102));
    EXPECT_EQ(bench.arm->state().commanded_position, motion.target_joints);
}

TEST_F(PlannedMoves, SettingsThatTheCabinetHasAreNotToldAgain) {
    ASSERT_TRUE(run(ArmBench::toJoints(0.1)));
    const auto before = bench.cabinet->codes().size();
    ASSERT_TRUE(run(ArmBench::toJoints(0.2)));
    EXPECT_THAT(codesSince(before), ElementsAre(102));
}

TEST_F(PlannedMoves, ALineIsTheFlangesPoseInTheCabinetsUnits) {
    auto motion = line(0.2);
    motion.line_velocity = 0.25;
    motion.line_acceleration = 1.5;
    const auto before = bench.cabinet->codes().size();
    ASSERT_TRUE(run(motion));
    EXPECT_THAT(codesSince(before), ElementsAre(201, 202, 204, 205, 303, 211, 103));
    const auto commands = bench.cabinet->commands();
    EXPECT_EQ(commands[before + 2][1], 250);
    EXPECT_EQ(commands[before + 3][1], 1500);
    EXPECT_EQ(commands[before + 4][1], 22);
    const auto& pose = commands.back();
    EXPECT_NEAR(pose[1], 1000 * motion.target_flange->x, 1e-3);
    EXPECT_NEAR(pose[4], motion.target_flange->c, 1e-6);
    EXPECT_NEAR(pose[6], motion.target_flange->a, 1e-6);
}

TEST_F(PlannedMoves, ALineWithoutASpeedOfItsOwnDoesNotTakeThatOfTheLineBefore) {
    auto slow = line(0.1);
    slow.line_velocity = 0.02;
    slow.line_acceleration = 0.1;
    ASSERT_TRUE(run(slow));
    const auto before = bench.cabinet->codes().size();
    ASSERT_TRUE(run(line(0.2)));
    ASSERT_THAT(codesSince(before), ElementsAre(204, 205, 103));
    EXPECT_EQ(bench.cabinet->commands()[before][1], 1000) << "as the robot application begins";
}

TEST_F(PlannedMoves, APoseCanBeReachedByPtpToo) {
    auto motion = line(0.2);
    motion.path = ControllerPlannedMotion::Path::joint;
    ASSERT_TRUE(run(motion));
    const auto commands = bench.cabinet->commands();
    EXPECT_EQ(commands[commands.size() - 3][0], 303);
    EXPECT_EQ(commands[commands.size() - 3][1], 21);
}

TEST_F(PlannedMoves, AMoveToWhereTheArmStandsIsDone) {
    EXPECT_TRUE(run(ArmBench::toJoints(0.0)));
}

TEST_F(PlannedMoves, AForceConditionThatIsMetEndsTheMotionWithItsForce) {
    bench.cabinet->change([](auto& behaviour) { behaviour.contact_after = 0.1; });
    auto motion = ArmBench::toJoints(0.5);
    motion.until = device::ForceCondition{{std::nullopt, std::nullopt, 20.0}};
    const auto outcome = run(motion);
    ASSERT_TRUE(outcome);
    EXPECT_EQ(outcome->end, MotionOutcome::End::force);
    EXPECT_EQ(outcome->force[2], 50.0);
    EXPECT_EQ(outcome->largest_force[1], 2.0);
    EXPECT_LT(bench.cabinet->position()[0], 0.3);
}

TEST_F(PlannedMoves, TheMotionAfterAContactIsNotTakenForOne) {
    bench.cabinet->change([](auto& behaviour) { behaviour.contact_after = 0.1; });
    auto motion = ArmBench::toJoints(0.5);
    motion.until = device::ForceCondition{{std::nullopt, std::nullopt, 20.0}};
    ASSERT_TRUE(run(motion));
    const auto back = run(ArmBench::toJoints(0.0));
    ASSERT_TRUE(back);
    EXPECT_EQ(back->end, MotionOutcome::End::at_target);
    EXPECT_NEAR(bench.cabinet->position()[0], 0.0, kNear);
}

TEST_F(PlannedMoves, StopMotionCancelsAndTellsAtStandstill) {
    Outcome outcome;
    bench.cabinet->change([](auto& behaviour) { behaviour.speed = 0.2; });
    ASSERT_TRUE(bench.arm->move(ArmBench::toJoints(2.5), outcome.taker()));
    ASSERT_TRUE(until([&] { return bench.cabinet->moving(); }));
    bench.arm->stopMotion();
    ASSERT_TRUE(until([&] { return outcome.told(); }));
    EXPECT_EQ(outcome.get()->end, MotionOutcome::End::stopped);
    EXPECT_TRUE(bench.arm->state().standstill);
    EXPECT_EQ(bench.cabinet->codes().back(), 101);
    EXPECT_TRUE(run(ArmBench::toJoints(0.3)));
}

TEST_F(PlannedMoves, OneMotionAtATimeAndNoStreamMeanwhile) {
    Outcome first;
    Outcome second;
    bench.cabinet->change([](auto& behaviour) { behaviour.speed = 0.2; });
    ASSERT_TRUE(bench.arm->move(ArmBench::toJoints(2.0), first.taker()));
    const auto refused = bench.arm->move(ArmBench::toJoints(0.0), second.taker());
    EXPECT_EQ(refused.error().code, Errc::resource_unavailable);
    const auto stream = std::make_shared<Stream>([](int, auto&) { return Stream::Next::done; });
    EXPECT_EQ(bench.arm->attach(stream).error().code, Errc::resource_unavailable);
    bench.arm->stopMotion();
    ASSERT_TRUE(until([&] { return first.told(); }));
    EXPECT_FALSE(second.told());
}

TEST_F(PlannedMoves, WhatTheCabinetWouldReplaceInSilenceIsRefusedBefore) {
    Outcome outcome;
    const auto before = bench.cabinet->codes().size();
    auto beyond = ArmBench::toJoints(3.2);
    EXPECT_THAT(bench.arm->move(beyond, outcome.taker()).error().message, HasSubstr("axis 1"));
    beyond = ArmBench::toJoints(std::nan(""));
    EXPECT_FALSE(bench.arm->move(beyond, outcome.taker()));
    auto share = ArmBench::toJoints(0.1);
    share.velocity_share = 0.0;
    EXPECT_FALSE(bench.arm->move(share, outcome.taker()));
    auto far = line(0.1);
    far.target_flange->x = 5.0;
    EXPECT_EQ(bench.arm->move(far, outcome.taker()).error().code, Errc::unreachable);
    ControllerPlannedMotion nowhere;
    nowhere.path = ControllerPlannedMotion::Path::line;
    EXPECT_FALSE(bench.arm->move(nowhere, outcome.taker()));
    EXPECT_EQ(bench.cabinet->codes().size(), before);
}

TEST_F(PlannedMoves, AMoveThatTheCabinetIgnoresInSilenceIsNoticedByItsDistance) {
    bench.cabinet->change([](auto& behaviour) { behaviour.ignores_moves = true; });
    const auto outcome = run(ArmBench::toJoints(0.5));
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().code, Errc::device_fault);
    EXPECT_THAT(outcome.error().message, HasSubstr("axis 1 0.5000 rad from its target"));
}

TEST_F(PlannedMoves, ARefusedCommandIsNamed) {
    bench.cabinet->change([](auto& behaviour) { behaviour.refused.insert(211); });
    const auto outcome = run(ArmBench::toJoints(0.5));
    ASSERT_FALSE(outcome);
    EXPECT_THAT(outcome.error().message, HasSubstr("force condition (211)"));
    EXPECT_EQ(bench.cabinet->codes().back(), 211) << "nothing moved";
}

TEST_F(PlannedMoves, AConditionIsToldAgainAfterTheCabinetRefusedAnother) {
    auto watched = ArmBench::toJoints(0.2);
    watched.until = device::ForceCondition{{std::nullopt, std::nullopt, 20.0}};
    ASSERT_TRUE(run(watched));
    bench.cabinet->change([](auto& behaviour) { behaviour.refused.insert(211); });
    EXPECT_FALSE(run(ArmBench::toJoints(0.3)));
    bench.cabinet->change([](auto& behaviour) { behaviour.refused.clear(); });
    watched.target_joints[0] = 0.4;
    const auto before = bench.cabinet->codes().size();
    ASSERT_TRUE(run(watched));
    EXPECT_THAT(codesSince(before), ElementsAre(211, 102)) << "a cabinet may have switched it off";
}

TEST_F(PlannedMoves, TheStickyErrorIsToldOnceForTheMotionThatMadeIt) {
    bench.cabinet->change([](auto& behaviour) {
        behaviour.error_of_next_move = -14;
        behaviour.ignores_moves = true;
    });
    const auto failed = run(ArmBench::toJoints(0.5));
    ASSERT_FALSE(failed);
    EXPECT_THAT(failed.error().message, HasSubstr("error -14: asynchronous motion failed"));
    bench.cabinet->change([](auto& behaviour) { behaviour.ignores_moves = false; });
    EXPECT_TRUE(run(ArmBench::toJoints(0.5))) << "the old error still stands in every state";
}

TEST_F(PlannedMoves, AnObserverSeesTheArmInEveryCycle) {
    class Counter final : public device::MotionObserver {
    public:
        void observe(const device::ArmState& state) noexcept override {
            ++count;
            last = state.position[0];
        }
        std::atomic<int> count{0};
        std::atomic<double> last{0.0};
    };
    const auto counter = std::make_shared<Counter>();
    auto motion = ArmBench::toJoints(0.5);
    motion.observer = counter;
    ASSERT_TRUE(run(motion));
    EXPECT_GT(counter->count.load(), 10);
    EXPECT_NEAR(counter->last.load(), 0.5, kNear);
}

/// A motion whose cabinet is asked by hand, every 10 ms of its time.
class RunByHand {
public:
    explicit RunByHand(double target) : motion_(ArmBench::toJoints(target)) {
        state_.executed = state_.ready = true;
        state_.position = ArmBench::toJoints(0.0).target_joints;
        state_.velocity = device::JointArray(kAxes);
        run_.begin({motion_, {}}, state_, settings_);
    }

    /// The cabinet moves axis 1 with this speed; whether nothing ends the motion in `seconds`.
    bool movesFor(double seconds, double speed) {
        constexpr double kStep = 0.01;
        state_.active = true;
        state_.velocity[0] = speed;
        for (double time = 0.0; time < seconds; time += kStep) {
            const auto command = run_.command();
            state_.position[0] += kStep * speed;
            if (run_.take(command, state_, kStep, settings_) || command.code == Code::cancel) {
                return false;
            }
        }
        return true;
    }
    RunEnd::Cause arrives() {
        state_.active = false;
        state_.velocity[0] = 0.0;
        while (!run_.take(run_.command(), state_, 0.01, settings_)) {
        }
        return run_.end().cause;
    }

private:
    device::ControllerPlannedMotion motion_;
    CabinetState state_;
    CabinetSettings settings_;
    ControllerPlannedRun run_;
};

TEST(SlowPlannedMove, IsNoStandstillHoweverSlow) {
    RunByHand run(0.12);
    EXPECT_TRUE(run.movesFor(120.0, 1e-3)) << "[s], [rad/s]";
    EXPECT_EQ(run.arrives(), RunEnd::Cause::at_target);
}

TEST(SlowPlannedMove, ThatStopsOnItsWayIsGivenUp) {
    RunByHand run(0.12);
    ASSERT_TRUE(run.movesFor(10.0, 1e-3));
    EXPECT_TRUE(run.movesFor(2.9, 0.0));
    EXPECT_FALSE(run.movesFor(0.3, 0.0));
}

TEST(PlannedMovesOfASlowCabinet, AreDoneToo) {
    for (const bool double_precision : {false, true}) {
        ArmBench bench({.double_precision = double_precision, .delay = 7ms});
        ASSERT_TRUE(bench.ready());
        Outcome outcome;
        ASSERT_TRUE(bench.arm->move(ArmBench::toJoints(0.5), outcome.taker()));
        ASSERT_TRUE(until([&] { return outcome.told(); }));
        EXPECT_TRUE(outcome.get());
        EXPECT_GT(bench.arm->state().missed_cycles, 0U);
    }
}

TEST(PlannedMovesWithATool, AreSentForTheToolThatTheCabinetKnows) {
    auto options = ArmBench::quick();
    options.tool = 3;
    const auto model = iiwa7();
    auto arm = IiwaArm::create(options, model).value();
    ScriptedCabinet cabinet(arm->port(), {.behaviour = {.tool_length = 0.2}});
    ASSERT_TRUE(until([&] { return arm->state().safety == SafetyState::normal; }));
    EXPECT_EQ(cabinet.codes().back(), 400);
    const auto joints = ArmBench::toJoints(0.3).target_joints;
    ControllerPlannedMotion motion;
    motion.target_flange = motion::toFrame(
        model.kinematics().forward(motion::JointVector::from(joints.values()).value()));
    Outcome outcome;
    ASSERT_TRUE(arm->move(motion, outcome.taker()));
    ASSERT_TRUE(until([&] { return outcome.told(); }));
    ASSERT_TRUE(outcome.get()) << outcome.get().error().message;
    EXPECT_NEAR(cabinet.position()[0], 0.3, kNear);
}

}  // namespace
}  // namespace metier::iiwa_driver
