#include "options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "metier/base/numbers.hpp"

namespace metier::edo_driver {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

device::OpenRequest request() {
    device::OpenRequest request;
    request.name = "edo";
    request.address = "10.42.0.49";
    return request;
}

TEST(Options, HaveDefaults) {
    const auto options = readOptions(request()).value();
    EXPECT_EQ(options.host, "10.42.0.49");
    EXPECT_EQ(options.port, 9090);
    EXPECT_FALSE(options.generation);
    EXPECT_EQ(options.layout.count(), 7U);
    EXPECT_EQ(options.layout.mask(), 127U);
    EXPECT_EQ(options.axis_names.size(), 6U);
    EXPECT_EQ(options.joint_timeout, 100ms);
    EXPECT_NEAR(options.reset.offset, 3.5 * std::numbers::pi / 180.0, 1e-12);
    EXPECT_FALSE(options.start_on_connect);
    EXPECT_NEAR(options.axes[0].velocity, 22.79 * std::numbers::pi / 180.0, 1e-12);
}

TEST(Options, AreRead) {
    auto asked = request();
    asked.settings.set("port", 9091.0);
    asked.settings.set("generation", std::string("classic"));
    asked.settings.set("gripper", false);
    asked.settings.set("joint_timeout", 0.05);
    asked.settings.set("grasp_shortfall_mm", 5.0);
    const auto options = readOptions(asked).value();
    EXPECT_EQ(options.port, 9091);
    EXPECT_EQ(options.generation->kind, Generation::Kind::classic);
    EXPECT_EQ(options.layout.mask(), 63U);
    EXPECT_EQ(options.joint_timeout, 50ms);
    EXPECT_DOUBLE_EQ(options.gripper.grasp_shortfall, 0.005);
}

TEST(Options, TakeAGenerationInsteadOfTheSoftwareVersion) {
    auto asked = request();
    asked.settings.set("generation", std::string("external"));
    EXPECT_EQ(readOptions(asked)->generation->kind, Generation::Kind::external);
    asked.settings.set("generation", std::string("auto"));
    EXPECT_FALSE(readOptions(asked)->generation);
}

TEST(Options, HaveTheLimitsOfTheRobotsOwnConfiguration) {
    const auto options = readOptions(request()).value();
    for (std::size_t axis = 0; axis < 6; ++axis) {
        const bool wrist = axis >= 3;
        EXPECT_EQ(options.axis_names[axis], "J" + std::to_string(axis + 1));
        EXPECT_DOUBLE_EQ(options.axes[axis].lower, -options.axes[axis].upper);
        EXPECT_NEAR(options.axes[axis].velocity, (wrist ? 33.59 : 22.79) * kDegree, 1e-12);
        EXPECT_NEAR(options.axes[axis].acceleration, 2 * (wrist ? 67.2 : 45.6) * kDegree, 1e-12);
    }
    EXPECT_NEAR(options.axes[1].upper, 99 * kDegree, 1e-12);
}

TEST(Options, HaveTheNamesAndLimitsOfTheModelIfThereIsOne) {
    const auto model = motion::RobotModel::load(METIER_MODELS_DIR "/edo.toml").value();
    auto asked = request();
    asked.model = &model;
    const auto options = readOptions(asked).value();
    ASSERT_EQ(options.axis_names.size(), model.axisCount());
    for (std::size_t axis = 0; axis < model.axisCount(); ++axis) {
        const auto& limits = model.limits(axis);
        EXPECT_EQ(options.axis_names[axis], model.chain().joints[axis].name);
        EXPECT_EQ(options.axes[axis].lower, limits.lower);
        EXPECT_EQ(options.axes[axis].upper, limits.upper);
        EXPECT_EQ(options.axes[axis].velocity, limits.velocity);
        EXPECT_EQ(options.axes[axis].acceleration, 2 * limits.acceleration);
    }
}

TEST(Options, RefuseAModelOfTooManyAxes) {
    const auto model = motion::RobotModel::load(METIER_MODELS_DIR "/iiwa7.toml").value();
    auto asked = request();
    asked.model = &model;
    const auto options = readOptions(asked);
    ASSERT_FALSE(options);
    EXPECT_EQ(options.error().message, "edo: the model has 7 axes, an e.DO at most 6");
}

TEST(Options, AreReadInTheirUnits) {
    auto asked = request();
    asked.settings.set("machine_timeout", 2.0);
    asked.settings.set("hold_control", 0.5);
    asked.settings.set("following_time", 0.25);
    asked.settings.set("following_distance", 0.2);
    asked.settings.set("gripper_timeout", 3.0);
    asked.settings.set("gripper_speed", 0.02);
    asked.settings.set("grasp_current", 0.5);
    asked.settings.set("stroke", 0.06);
    asked.settings.set("reset_steps", 1500.0);
    asked.settings.set("reset_offset_deg", 2.0);
    asked.settings.set("start_on_connect", true);
    const auto options = readOptions(asked).value();
    EXPECT_EQ(options.machine_timeout, 2s);
    EXPECT_EQ(options.hold_control, 500ms);
    EXPECT_EQ(options.following.time, 250ms);
    EXPECT_EQ(options.following.distance, 0.2);
    EXPECT_EQ(options.gripper.timeout, 3s);
    EXPECT_EQ(options.gripper.speed, 0.02);
    EXPECT_EQ(options.gripper.grasp_current, 0.5);
    EXPECT_EQ(options.gripper.stroke, 0.06);
    EXPECT_EQ(options.reset.steps, 1500U);
    EXPECT_NEAR(options.reset.offset, 2.0 * std::numbers::pi / 180.0, 1e-12);
    EXPECT_TRUE(options.start_on_connect);
}

TEST(Options, TellEverythingThatIsWrong) {
    auto asked = request();
    asked.settings.set("generation", std::string("newest"));
    asked.settings.set("prot", 9091.0);
    asked.settings.set("stroke", 8.0);
    const auto options = readOptions(asked);
    ASSERT_FALSE(options);
    EXPECT_EQ(options.error().code, Errc::invalid_argument);
    EXPECT_THAT(options.error().message,
                AllOf(HasSubstr("generation"), HasSubstr("prot"), HasSubstr("stroke")));
}

}  // namespace
}  // namespace metier::edo_driver
