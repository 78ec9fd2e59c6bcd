#include "metier/device/driver.hpp"

#include <gmock/gmock.h>

#include "arm_bench.hpp"

namespace metier::device {
Driver iiwaDriver();
}

namespace metier::iiwa_driver {
namespace {

using ::testing::HasSubstr;
using Values = std::map<std::string, cell::Settings::Value>;

class IiwaDriver : public ::testing::Test {
protected:
    Result<device::OpenDevice> open(Values values) {
        values.try_emplace("port", 0.0);
        return device::iiwaDriver().open(
            {"arm", "127.0.0.1", cell::Settings("cell.toml: arm", std::move(values)), &model});
    }
    const motion::RobotModel model = iiwa7();
};

TEST_F(IiwaDriver, OffersAnArmAPlannerAndASensorOfOneThing) {
    const auto device = open({});
    ASSERT_TRUE(device) << device.error().message;
    ASSERT_NE(device->arm, nullptr);
    EXPECT_NE(device->planner, nullptr);
    EXPECT_NE(device->force_torque_sensor, nullptr);
    EXPECT_EQ(device->arm->info().name, "arm");
    EXPECT_EQ(device->arm->info().cycle, 10ms);
    EXPECT_EQ(device->arm->info().axisCount(), 7U);
    EXPECT_EQ(device->arm->state().safety, device::SafetyState::disconnected);
}

TEST_F(IiwaDriver, TellsAllThatIsWrongInItsSettings) {
    const auto device = open({{"precision", std::string("half")},
                              {"poll_period_ms", 0.0},
                              {"answer_timeout_ms", -1.0},
                              {"prot", 1.0}});
    ASSERT_FALSE(device);
    for (const auto* name : {"precision", "poll_period_ms", "answer_timeout_ms", "prot"}) {
        EXPECT_THAT(device.error().message, HasSubstr(name));
    }
}

TEST_F(IiwaDriver, NeedsAModelOfSevenAxesAndAnAddressOfThisComputer) {
    device::OpenRequest request{"arm", "127.0.0.1", {}, nullptr};
    EXPECT_FALSE(device::iiwaDriver().open(request));
    const auto ur5 = motion::RobotModel::load(std::string(METIER_MODELS_DIR) + "/ur5.toml").value();
    request.model = &ur5;
    EXPECT_THAT(device::iiwaDriver().open(request).error().message, HasSubstr("6 axes"));
    request.model = &model;
    request.address = "192.0.2.1";
    EXPECT_EQ(device::iiwaDriver().open(request).error().code, Errc::invalid_argument);
}

TEST_F(IiwaDriver, TalksInThePrecisionOfItsSettings) {
    for (const bool twice : {false, true}) {
        const std::string precision = twice ? "double" : "single";
        const auto device =
            open({{"port", 0.0}, {"precision", precision}, {"answer_timeout_ms", 5000.0}});
        ASSERT_TRUE(device) << device.error().message;
        const auto& arm = dynamic_cast<const IiwaArm&>(*device->arm);
        const ScriptedCabinet cabinet(arm.port(), {.double_precision = twice});
        EXPECT_TRUE(until([&] { return arm.state().safety == device::SafetyState::normal; }))
            << precision;
    }
}

TEST_F(IiwaDriver, NeedsTimesOverZero) {
    for (auto IiwaOptions::*time : {&IiwaOptions::cycle, &IiwaOptions::answer_timeout}) {
        auto options = ArmBench::quick();
        options.*time = 0ms;
        const auto arm = IiwaArm::create(options, model);
        ASSERT_FALSE(arm);
        EXPECT_EQ(arm.error().code, Errc::invalid_argument);
        EXPECT_EQ(arm.error().message, "iiwa: cycle and answer time-out must be over 0");
    }
}

TEST_F(IiwaDriver, ThePortCanBeTakenOnlyOnce) {
    const auto arm = IiwaArm::create(ArmBench::quick(), model).value();
    const auto second = open({{"port", static_cast<double>(arm->port())}});
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::already_exists);
}

TEST(IiwaFlangeForce, IsTheCabinetsEstimateAndCanBeMadeZero) {
    auto options = ArmBench::quick();
    options.answer_timeout = 1s;  // after as long the sensor has no measurement
    ArmBench bench({}, options);
    ASSERT_TRUE(bench.ready());
    auto& sensor = bench.arm->flangeForce();
    EXPECT_EQ(sensor.sample().health, device::SafetyState::normal);
    EXPECT_EQ(sensor.sample().force, (std::array{1.0, -2.0, 0.5}));
    ASSERT_TRUE(sensor.tare());
    EXPECT_EQ(sensor.sample().force, (std::array{0.0, 0.0, 0.0}));
    bench.cabinet->die();
    EXPECT_TRUE(until([&] { return sensor.sample().health == device::SafetyState::disconnected; }));
    EXPECT_FALSE(sensor.tare());
}

}  // namespace
}  // namespace metier::iiwa_driver
