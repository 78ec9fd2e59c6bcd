#include "metier/virtual_controller/standing_time.hpp"

#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>

namespace metier::virtual_controller {
namespace {

using namespace std::chrono_literals;

constexpr SteadyTime kStart{1h};

/// An arm of two axes with a cycle of 10 ms.
class StandingArm : public ::testing::Test {
protected:
    /// So many cycles, in each of which axis 2 goes by `step` [rad].
    void cycles(int count, double step) {
        for (int i = 0; i < count; ++i) {
            position_[1] += step;
            now_ += 10ms;
            time_.take(position_, now_);
        }
    }
    double standing() const { return time_.standing(now_).count(); }

    std::array<double, 2> position_{0.5, -1.0};
    SteadyTime now_ = kStart;
    StandingTime time_;
};

TEST_F(StandingArm, HasNotStoodWhileItMoves) {
    cycles(10, 0.01);
    EXPECT_DOUBLE_EQ(standing(), 0.0);
}

TEST_F(StandingArm, StandsSinceItsLastMotion) {
    cycles(10, 0.01);
    cycles(25, 0.0);
    EXPECT_NEAR(standing(), 0.25, 1e-9);
}

TEST_F(StandingArm, MovesHoweverSlowly) {
    cycles(100, 2e-5);
    EXPECT_LT(standing(), 0.06) << "2 mrad/s";
}

TEST_F(StandingArm, TellsOfTheLongestCycleOfItsLastMotion) {
    cycles(10, 0.01);
    now_ += 1s;
    cycles(50, 0.0);
    EXPECT_NEAR(time_.longestCycle().count(), 1.01, 1e-9);
    cycles(10, 0.01);
    EXPECT_NEAR(time_.longestCycle().count(), 0.01, 1e-9);
}

TEST_F(StandingArm, ShowsItInSeconds) {
    cycles(10, 0.01);
    cycles(5, 0.0);
    nlohmann::ordered_json state;
    time_.show(state, now_);
    EXPECT_NEAR(state.at("standing_for").get<double>(), 0.05, 1e-9);
    EXPECT_NEAR(state.at("longest_cycle").get<double>(), 0.01, 1e-9);
}

}  // namespace
}  // namespace metier::virtual_controller
