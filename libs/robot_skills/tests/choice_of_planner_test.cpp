// Choice of the planner for a move of an arm whose controller plans, too: the controller if its
// motion is the one that was asked for, else metier's set-points. A client sees no difference.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>

#include "controller_planned_bench.hpp"
#include "moves/timetable.hpp"

namespace metier::robot_skills {
namespace {

using skill::Frame;
using skill::State;
using skill::ValueMap;

constexpr double kCycle = 0.001;  // [s]
const ValueMap kUp{{"TargetPosition", Frame{0, 0, 0.1}}, {"Relative", std::int32_t{1}}};
const ValueMap kTurn{{"TargetJointPosition", std::vector<double>(7, 0.2)},
                     {"Relative", std::int32_t{1}}};

ValueMap with(ValueMap values, const ValueMap& more) {
    values.insert(more.begin(), more.end());
    return values;
}

struct Move {
    const char* name;
    const std::string& skill;
    ValueMap values;
    enum class By { controller, set_points } by;
};

void PrintTo(const Move& move, std::ostream* out) {
    *out << move.name;
}

std::vector<Move> moves() {
    using enum Move::By;
    const auto accelerations = [](double linear, double angular) {
        return ValueMap{{"MaxAcceleration",
                         std::vector<double>{linear, linear, linear, angular, angular, angular}}};
    };
    return {
        {"ptp", kJointPtp, kTurn, controller},
        {"ptp_to_a_pose", kCartesianPtp, kUp, controller},
        {"line", kCartesianLinear, kUp, controller},
        {"slower_ptp", kJointPtp, with(kTurn, {{"SpeedOverride", 0.3}}), controller},
        {"accelerations_of_the_robot", kCartesianLinear, with(kUp, accelerations(2.5, 5)),
         controller},
        {"duration_of_a_ptp", kJointPtp, with(kTurn, {{"Duration", 3.0}}), set_points},
        {"duration_of_a_line", kCartesianLinear, with(kUp, {{"Duration", 3.0}}), set_points},
        {"stop_time_of_a_ptp", kJointPtp, with(kTurn, {{"StopTime", 0.5}}), set_points},
        {"low_acceleration_of_a_ptp", kJointPtp,
         with(kTurn, {{"MaxAcceleration", std::vector<double>(7, 0.5)}}), set_points},
        {"low_acceleration_of_a_line", kCartesianLinear, with(kUp, accelerations(0.5, 5)),
         set_points},
        {"elbow_that_turns", kCartesianLinear, with(kUp, {{"RedundancyAngle", 0.3}}), set_points},
        {"turn_on_the_spot",
         kCartesianLinear,
         {{"TargetPosition", Frame{0, 0, 0, 0, 0, 0.3}}, {"Relative", std::int32_t{1}}},
         set_points},
        {"creeping",
         kJointPtp,
         {{"TargetJointPosition", std::vector<double>(7, 1e-3)},
          {"Relative", std::int32_t{1}},
          {"SpeedOverride", 1e-3}},
         set_points},
    };
}

class ChoiceOfPlanner : public ::testing::TestWithParam<Move> {
protected:
    skill::Program& program() { return bench.program(GetParam().skill); }
    bool start() { return bench.start(GetParam().skill, GetParam().values).has_value(); }
    bool becomes(State state) { return bench.stepUntil(GetParam().skill, state); }
    std::size_t askedOfTheController(std::size_t times = 1) const {
        return GetParam().by == Move::By::controller ? times : 0U;
    }
    double result(const char* name) { return std::get<double>(program().finalResult().at(name)); }

    ControllerPlannedBench planned;
    Bench& bench = planned.bench;
};

TEST_P(ChoiceOfPlanner, EndsAtTheTarget) {
    const auto report = program().check(bench.caller(), GetParam().values);
    ASSERT_TRUE(report.possible) << report.reason;
    const auto& target = report.joint_path.back();
    ASSERT_TRUE(start());
    ASSERT_TRUE(becomes(State::ready)) << program().reasonText();
    EXPECT_EQ(planned.planner().asked.size(), askedOfTheController());
    for (std::size_t axis = 0; axis < target.size(); ++axis) {
        EXPECT_NEAR(bench.commanded()[axis], target[axis], 1e-6);
    }
    EXPECT_LT(result("LargestPathDeviation"), 1e-6);
    if (GetParam().by == Move::By::set_points) {
        EXPECT_NEAR(result("Duration"), report.planned_duration, 2 * kCycle);
    }
}

TEST_P(ChoiceOfPlanner, SuspendsResumesAndHaltsAtStandstill) {
    ASSERT_TRUE(start());
    bench.steps(60);
    ASSERT_TRUE(program().suspend(bench.caller()));
    ASSERT_TRUE(becomes(State::suspended)) << program().reasonText();
    EXPECT_TRUE(bench.arm().state().standstill);
    ASSERT_TRUE(program().resume(bench.caller()));
    EXPECT_EQ(planned.planner().asked.size(), askedOfTheController(2));
    bench.steps(60);
    ASSERT_TRUE(program().halt(bench.caller()));
    ASSERT_TRUE(becomes(State::halted));
    EXPECT_TRUE(bench.arm().state().standstill);
    EXPECT_EQ(program().reason(), skill::Reason::by_client);
    ASSERT_TRUE(program().reset(bench.caller()));
    EXPECT_TRUE(start()) << "the arm is free again";
}

INSTANTIATE_TEST_SUITE_P(Moves, ChoiceOfPlanner, ::testing::ValuesIn(moves()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(ChoiceOfPlannerByTime, AStartTimeIsKeptToTheCycle) {
    ControllerPlannedBench planned;
    auto& bench = planned.bench;
    const double start = toSeconds(bench.executor().clock().utcNow()) + 0.2;
    ASSERT_TRUE(bench.start(kJointPtp, with(kTurn, {{"StartTime", start}})));
    ASSERT_TRUE(bench.stepUntil(kJointPtp, State::ready));
    const auto begun =
        std::get<double>(bench.program(kJointPtp).finalResult().at("MotionStartTime"));
    EXPECT_GE(begun, start);
    EXPECT_LE(begun, start + kCycle + 1e-6);
    EXPECT_TRUE(planned.planner().asked.empty());
}

TEST(ChoiceOfPlannerByTime, ALongDurationIsTheMotionsLength) {
    ControllerPlannedBench planned;
    auto& bench = planned.bench;
    ASSERT_TRUE(bench.start(kCartesianLinear, with(kUp, {{"Duration", 50.0}})));
    ASSERT_TRUE(bench.stepUntil(kCartesianLinear, State::ready))
        << bench.program(kCartesianLinear).reasonText();
    EXPECT_NEAR(std::get<double>(bench.program(kCartesianLinear).finalResult().at("Duration")),
                50.0, 2 * kCycle);
}

}  // namespace
}  // namespace metier::robot_skills
