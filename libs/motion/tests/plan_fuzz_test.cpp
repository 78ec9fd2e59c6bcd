#include <gtest/gtest.h>

#include "plan_fuzz.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

TEST(PlannerFuzz, EveryMotionIsFiniteWithinItsLimitsAndAsLongAsItSays) {
    std::vector<RobotModel> models;
    for (const std::string& name : kRobots) {
        models.push_back(loadRobot(name));
    }
    PlanFuzz fuzz(models, 1);
    const int count = scaled(3000);
    for (int i = 0; i < count; ++i) {
        EXPECT_EQ(fuzz.next(), "") << "motion " << i;
    }
    EXPECT_GT(fuzz.planned(), count / 2);
}

}  // namespace
}  // namespace metier::motion
