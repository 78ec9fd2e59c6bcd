#include <gmock/gmock.h>

#include "arm_fixture.hpp"

namespace metier::ur_driver {
namespace {

using std::chrono::milliseconds;

class UrDriverTest : public ArmTest {
protected:
    /// Opens the driver with the fake's settings, but for these; without a frequency.
    Result<device::OpenDevice> opened(const Values& changed = {}) {
        auto values = fake_.settings();
        values.erase("frequency");
        for (const auto& [name, value] : changed) {
            values[name] = value;
        }
        return device::urDriver().open(
            {"ur5", "127.0.0.1", cell::Settings("cell.toml:3", values), model});
    }

    const motion::RobotModel* model = &model_;
};

TEST_F(UrDriverTest, TellsASettingThatIsWrong) {
    const auto device = opened({{"servoj_gain", 50.0}, {"colour", 1.0}});
    ASSERT_FALSE(device);
    EXPECT_EQ(device.error().code, Errc::invalid_argument);
    EXPECT_THAT(device.error().message,
                AllOf(HasSubstr("cell.toml:3"), HasSubstr("servoj_gain"), HasSubstr("colour")));
}

TEST_F(UrDriverTest, NeedsTheModelOfAnArmWithSixAxes) {
    model = nullptr;
    const auto without = opened();
    ASSERT_FALSE(without);
    EXPECT_EQ(without.error().code, Errc::invalid_argument);
    EXPECT_THAT(without.error().message, HasSubstr("ur5: driver ur needs the model"));
    const auto seven = motion::RobotModel::load(METIER_MODELS_DIR "/iiwa7.toml").value();
    model = &seven;
    EXPECT_EQ(opened().error().code, Errc::invalid_argument);
}

TEST_F(UrDriverTest, UsesTheModelsOwnKinematicsIfTheControllerHasAnotherArm) {
    fake_.set([](auto& k) { k.a[1] = -0.612; });
    auto device = opened();
    ASSERT_TRUE(device) << device.error().message;
    const auto home = model_.home();
    EXPECT_LT((device->model->kinematics().forward(home).translation -
               model_.kinematics().forward(home).translation)
                  .norm(),
              1e-9);
    EXPECT_TRUE(fake_.await([&] {
        return device->arm->safety().text.find("it has another arm") != std::string::npos;
    })) << device->arm->safety().text;
}

TEST_F(UrDriverTest, TakesTheFrequencyFromTheMajorVersion) {
    fake_.set([](auto& k) { k.major = 3; });
    EXPECT_EQ(opened()->arm->info().cycle, milliseconds(8));
    fake_.set([](auto& k) { k.major = 5; });
    EXPECT_EQ(opened()->arm->info().cycle, milliseconds(2));
    EXPECT_EQ(opened({{"frequency", 250.0}})->arm->info().cycle, milliseconds(4))
        << "the settings say otherwise";
}

TEST_F(UrDriverTest, TakesTheFrequencyFromTheModelOfAControllerThatIsNotThere) {
    fake_.switchOff();
    const auto device = opened({{"open_wait", 0.1}});
    ASSERT_TRUE(device) << device.error().message;
    EXPECT_EQ(device->arm->info().cycle, milliseconds(8));
    EXPECT_EQ(device->arm->safety().state, SafetyState::disconnected);
}

}  // namespace
}  // namespace metier::ur_driver
