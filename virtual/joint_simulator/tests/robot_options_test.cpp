#include "metier/joint_simulator/robot_options.hpp"

#include <gtest/gtest.h>

namespace metier::joint_simulator {
namespace {

using namespace std::chrono_literals;

struct Robot {
    const char* file;
    std::size_t axes;
    std::chrono::nanoseconds cycle;
};

class RobotOptions : public ::testing::TestWithParam<Robot> {};

TEST_P(RobotOptions, MakeAnArmThatStandsAtHome) {
    const auto model =
        motion::RobotModel::load(std::string(METIER_MODELS_DIR) + "/" + GetParam().file);
    ASSERT_TRUE(model) << model.error().message;
    const auto arm = JointSimulator::create(optionsFor(*model));
    ASSERT_TRUE(arm) << arm.error().message;
    EXPECT_EQ((*arm)->info().axisCount(), GetParam().axes);
    EXPECT_EQ((*arm)->info().cycle, GetParam().cycle);
    EXPECT_EQ((*arm)->state().position[1], model->home()[1]);
}

INSTANTIATE_TEST_SUITE_P(All, RobotOptions,
                         ::testing::Values(Robot{"ur5.toml", 6, 8ms}, Robot{"iiwa7.toml", 7, 1ms},
                                           Robot{"edo.toml", 6, 10ms}),
                         [](const auto& test) {
                             const std::string file = test.param.file;
                             return file.substr(0, file.find('.'));
                         });

}  // namespace
}  // namespace metier::joint_simulator
