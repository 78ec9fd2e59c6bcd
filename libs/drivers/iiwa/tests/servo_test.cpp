#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "arm_bench.hpp"

namespace metier::iiwa_driver {
namespace {

using device::EndCause;
using device::SafetyState;
using Next = device::SetPointSource::Next;
using ::testing::HasSubstr;

/// Turns axis 1 and then rests: the arm is at the last set-point also if some were left out.
std::shared_ptr<Stream> turning(double step, int cycles) {
    return std::make_shared<Stream>([=](int cycle, device::JointArray& set_point) {
        constexpr int kRest = 10;
        if (cycle >= cycles + kRest) {
            return Next::done;
        }
        set_point[0] += cycle < cycles ? step : 0.0;
        return Next::set_point;
    });
}

class Servo : public ::testing::Test {
protected:
    Servo() { EXPECT_TRUE(bench.ready()); }

    void run(const std::shared_ptr<Stream>& stream) {
        ASSERT_TRUE(bench.arm->attach(stream));
        ASSERT_TRUE(until([&] { return stream->ends() == 1; }));
    }

    ArmBench bench;
};

TEST_F(Servo, EveryCycleSendsItsSetPointOnceTheServoInterfaceIsChosen) {
    const auto before = bench.cabinet->codes().size();
    const auto stream = turning(1e-3, 100);
    run(stream);
    EXPECT_EQ(stream->cause(), EndCause::done);
    const auto commands = bench.cabinet->commands();
    EXPECT_EQ(commands[before][0], 201);
    EXPECT_EQ(commands[before + 1][0], 202);
    EXPECT_EQ(commands[before + 2][0], 302);
    EXPECT_EQ(commands[before + 2][1], 32);
    double last = 0.0;
    for (std::size_t i = before + 3; i < commands.size() && commands[i][0] == 102; ++i) {
        const double cycles = (commands[i][1] - last) / 1e-3;
        EXPECT_NEAR(cycles, std::round(cycles), 1e-2);
        EXPECT_LE(cycles, 5.01) << "more than one where the computer was late";
        last = commands[i][1];
    }
    EXPECT_NEAR(last, 0.1, 1e-6);
    EXPECT_NEAR(bench.arm->state().commanded_position[0], 0.1, 1e-9);
}

TEST_F(Servo, AfterAStreamTheStandardInterfaceIsBack) {
    run(turning(1e-3, 10));
    EXPECT_TRUE(until([&] { return bench.cabinet->commands().back()[0] == 302; }));
    EXPECT_EQ(bench.cabinet->commands().back()[1], 31);
}

TEST_F(Servo, AStreamCanFollowAStreamAtOnce) {
    run(turning(1e-3, 10));
    run(turning(-1e-3, 10));
    EXPECT_NEAR(bench.arm->state().commanded_position[0], 0.0, 3e-3);
}

TEST(ServoOfASlowCabinet, KeepsItsTimeByLeavingSetPointsOut) {
    ArmBench bench({.delay = 10ms});  // two and a half cycles
    ASSERT_TRUE(bench.ready());
    const auto stream = turning(1e-3, 250);
    ASSERT_TRUE(bench.arm->attach(stream));
    ASSERT_TRUE(until([&] { return stream->ends() == 1; }));
    const auto codes = bench.cabinet->codes();
    EXPECT_LT(std::count(codes.begin(), codes.end(), 102), 125)
        << "of 250 set-points: each answer takes two and a half cycles";
    EXPECT_NEAR(bench.arm->state().commanded_position[0], 0.25, 1e-9);
    EXPECT_GT(bench.arm->state().missed_cycles, 50U);
}

TEST_F(Servo, StopCancelsAndTellsAtStandstill) {
    const auto stream = turning(1e-3, 1'000'000);
    ASSERT_TRUE(bench.arm->attach(stream));
    ASSERT_TRUE(until([&] { return bench.arm->state().position[0] > 0.05; }));
    bench.arm->stop();
    ASSERT_TRUE(until([&] { return stream->ends() == 1; }));
    EXPECT_EQ(stream->cause(), EndCause::stopped);
    EXPECT_TRUE(bench.arm->state().standstill);
    EXPECT_THAT(bench.cabinet->codes(), ::testing::Contains(101));
}

TEST_F(Servo, ASetPointThatTheCabinetWouldReplaceInSilenceIsNeverSent) {
    const std::vector<std::pair<double, std::string>> bad{
        {std::numeric_limits<double>::quiet_NaN(), "iiwa: axis 1: set-point is not finite"},
        {3.0, "iiwa: axis 1: set-point 3.0000 rad beyond limit 2.9671 rad"},
        {-3.0, "iiwa: axis 1: set-point -3.0000 rad beyond limit -2.9671 rad"},
        {0.5, "iiwa: axis 1: set-point 0.5000 rad from the one before"}};
    for (const auto& [value, text] : bad) {
        const auto stream =
            std::make_shared<Stream>([value = value](int cycle, device::JointArray& set_point) {
                set_point[0] = cycle < 5 ? 0.0 : value;
                return Next::set_point;
            });
        run(stream);
        EXPECT_EQ(stream->cause(), EndCause::safety);
        EXPECT_TRUE(stream->safety().limit_violated);
        EXPECT_THAT(stream->safety().text, HasSubstr(text));
        EXPECT_EQ(bench.arm->safety().state, SafetyState::protective_stop);
        EXPECT_FALSE(bench.arm->attach(stream));
        EXPECT_TRUE(bench.arm->resetFault());
        EXPECT_EQ(bench.arm->safety().state, SafetyState::normal);
        for (const auto& command : bench.cabinet->commands()) {
            EXPECT_FALSE(command[0] == 102 && !(std::abs(command[1]) < 0.1));
        }
    }
}

TEST_F(Servo, AnArmThatDoesNotFollowIsNoticedOnTheAxisThatIsFarthestBehind) {
    bench.cabinet->change([](auto& behaviour) { behaviour.ignores_moves = true; });
    const auto stream = std::make_shared<Stream>([](int, device::JointArray& set_point) {
        set_point[0] += 1e-3;
        set_point[2] += 2e-3;
        set_point[6] -= 1e-3;
        return Next::set_point;
    });
    run(stream);
    EXPECT_EQ(stream->cause(), EndCause::safety);
    EXPECT_FALSE(stream->safety().limit_violated);
    EXPECT_THAT(stream->safety().text, HasSubstr("iiwa: axis 3 is 0."));
    EXPECT_THAT(stream->safety().text, HasSubstr("from its set-point, limit 0.2000 rad"));
}

TEST_F(Servo, ARefusedServoInterfaceEndsTheStream) {
    bench.cabinet->change([](auto& behaviour) { behaviour.refused.insert(302); });
    const auto stream = turning(1e-3, 10);
    run(stream);
    EXPECT_EQ(stream->cause(), EndCause::safety);
    EXPECT_THAT(stream->safety().text, HasSubstr("control interface (302)"));
}

}  // namespace
}  // namespace metier::iiwa_driver
