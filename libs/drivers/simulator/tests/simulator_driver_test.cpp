#include <gmock/gmock.h>

#include <algorithm>
#include <future>
#include <memory>

#include "metier/device/driver.hpp"

namespace metier::device {

Driver simulatorDriver();  // as cmake/MetierDevices.cmake declares it

namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

const motion::RobotModel kUr5 = motion::RobotModel::load(METIER_MODELS_DIR "/ur5.toml").value();

OpenRequest request(const motion::RobotModel* model,
                    std::map<std::string, cell::Settings::Value> settings = {}) {
    return {.name = "left arm",
            .address = {},
            .settings = cell::Settings("cell.toml:3: driver", std::move(settings)),
            .model = model};
}

/// Turns axis 1 within so many cycles, from rest to rest.
class TurningSource final : public SetPointSource {
public:
    explicit TurningSource(int cycles) : left_(cycles) {}
    Next next(const ArmState& /*state*/, JointArray& set_point) noexcept override {
        if (left_ == 0) {
            return Next::done;
        }
        // 2.5 rad/s2, to 0.5 rad/s.
        set_point[0] += 0.008 * 0.02 * std::min({++done_, --left_, 25});
        return Next::set_point;
    }
    void ended(EndCause cause, const Safety& /*safety*/) override { ended_.set_value(cause); }

    std::future<EndCause> end() { return ended_.get_future(); }

private:
    int left_;
    int done_ = 0;
    std::promise<EndCause> ended_;
};

TEST(SimulatorDriver, OpensAnArmOfTheModelAndNothingElse) {
    const auto device = simulatorDriver().open(request(&kUr5));
    ASSERT_TRUE(device) << device.error().message;
    ASSERT_NE(device->arm, nullptr);
    EXPECT_EQ(device->arm->info().name, "left arm");
    EXPECT_EQ(device->arm->info().axisCount(), 6U);
    EXPECT_EQ(device->arm->info().cycle, 8ms);
    EXPECT_EQ(device->arm->safety().state, SafetyState::normal);
    const auto state = device->arm->state();
    for (std::size_t axis = 0; axis < 6; ++axis) {
        EXPECT_EQ(state.position[axis], kUr5.home()[axis]) << axis;
    }
    EXPECT_EQ(device->planner, nullptr);
    EXPECT_EQ(device->gripper, nullptr);
    EXPECT_EQ(device->force_torque_sensor, nullptr);
    EXPECT_FALSE(device->model);
}

TEST(SimulatorDriver, MovesItsArmByItself) {
    const auto device = simulatorDriver().open(request(&kUr5)).value();
    const auto turn = std::make_shared<TurningSource>(50);
    auto end = turn->end();
    ASSERT_TRUE(device.arm->attach(turn));
    ASSERT_EQ(end.wait_for(30s), std::future_status::ready);
    EXPECT_EQ(end.get(), EndCause::done);
    EXPECT_NEAR(device.arm->state().commanded_position[0], kUr5.home()[0] + 0.1, 1e-9);
}

TEST(SimulatorDriver, EndsAMotionWhenItsOwnerLetsGo) {
    auto device = simulatorDriver().open(request(&kUr5)).value();
    const auto turn = std::make_shared<TurningSource>(100'000);
    auto end = turn->end();
    ASSERT_TRUE(device.arm->attach(turn));
    device.owner.reset();
    ASSERT_EQ(end.wait_for(0s), std::future_status::ready) << "at once";
    EXPECT_EQ(end.get(), EndCause::disconnected);
}

TEST(SimulatorDriver, OpensSeveralArmsSideBySide) {
    const auto left = simulatorDriver().open(request(&kUr5)).value();
    const auto right = simulatorDriver().open(request(&kUr5)).value();
    const auto turn = std::make_shared<TurningSource>(50);
    auto end = turn->end();
    ASSERT_TRUE(left.arm->attach(turn));
    ASSERT_EQ(end.wait_for(30s), std::future_status::ready);
    EXPECT_EQ(right.arm->state().commanded_position[0], kUr5.home()[0]);
    EXPECT_TRUE(simulatorDriver().port.setting.empty()) << "no port keeps others away";
}

TEST(SimulatorDriver, RefusesADeviceThatIsNoArm) {
    const auto device = simulatorDriver().open(request(nullptr));
    ASSERT_FALSE(device);
    EXPECT_EQ(device.error().code, Errc::invalid_argument);
    EXPECT_THAT(device.error().message, HasSubstr("left arm: "));
}

TEST(SimulatorDriver, RefusesSettings) {
    const auto device = simulatorDriver().open(request(&kUr5, {{"port", 5.0}}));
    ASSERT_FALSE(device);
    EXPECT_THAT(device.error().message, HasSubstr("cell.toml:3: driver.port: unknown"));
}

}  // namespace
}  // namespace metier::device
