#include <gtest/gtest.h>

#include "plan_fuzz.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

std::vector<RobotModel> everyRobot() {
    std::vector<RobotModel> models;
    for (const std::string& name : kRobots) {
        models.push_back(loadRobot(name));
    }
    return models;
}

// An iiwa passes a singularity: the joint positions left the interpolated path with another speed.
TEST(PlannerFuzz, LeavesASingularityWithoutAJolt) {
    const auto models = everyRobot();
    EXPECT_EQ(PlanFuzz(models, 52, 137'299).next(), "");
}

TEST(PlannerFuzz, EveryMotionIsFiniteWithinItsLimitsAndAsLongAsItSays) {
    const auto models = everyRobot();
    PlanFuzz fuzz(models, 1);
    const int count = scaled(3000);
    for (int i = 0; i < count; ++i) {
        EXPECT_EQ(fuzz.next(), "") << "motion " << i;
    }
    EXPECT_GT(fuzz.planned(), count / 2);
}

}  // namespace
}  // namespace metier::motion
