#include <gmock/gmock.h>

#include "netft_sensor.hpp"

namespace metier::device {
Driver netftDriver();
}

namespace metier::netft_driver {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

device::OpenRequest request(std::map<std::string, cell::Settings::Value> values) {
    return {.name = "wrist",
            .address = "127.0.0.1",
            .settings = cell::Settings("cell.toml:3: sensor", std::move(values))};
}

TEST(NetftDriver, NeedsNoSettings) {
    const auto options = readOptions(request({}));
    ASSERT_TRUE(options);
    EXPECT_EQ(options->port, 49152);
    EXPECT_EQ(options->http_port, 80);
    EXPECT_FALSE(options->calibration);
    EXPECT_FALSE(options->rate);
    EXPECT_FALSE(options->silence);
}

TEST(NetftDriver, WaitsFivePeriodsOfASlowSensor) {
    EXPECT_EQ(silenceAt(kUsualRate), 20ms);
    EXPECT_EQ(silenceAt(100.0), 50ms);
    EXPECT_EQ(silenceAt(7000.0), 20ms);
}

TEST(NetftDriver, TakesRateAndSilence) {
    EXPECT_EQ(readOptions(request({{"rate", 100.0}}))->rate, 100.0);
    EXPECT_EQ(readOptions(request({{"silence", 0.1}}))->silence, 100ms);
    EXPECT_THAT(readOptions(request({{"silence", 6.0}})).error().message,
                HasSubstr("silence: 6 is not within 0.001 to 5"));
}

TEST(NetftDriver, TakesUnitsAndPorts) {
    const auto options = readOptions(request({{"force_unit", std::string("lbf")},
                                              {"torque_unit", std::string("lbf-in")},
                                              {"port", 49153.0},
                                              {"http_port", 8080.0}}));
    ASSERT_TRUE(options) << options.error().message;
    EXPECT_EQ(options->units.force, "lbf");
    EXPECT_EQ(options->units.torque, "lbf-in");
    EXPECT_EQ(options->port, 49153);
    EXPECT_EQ(options->http_port, 8080);
    EXPECT_EQ(options->host, "127.0.0.1");
    EXPECT_EQ(options->name, "wrist");
}

TEST(NetftDriver, TakesCountsInsteadOfTheSensorsPage) {
    const auto options =
        readOptions(request({{"counts_per_force", 1e6}, {"counts_per_torque", 1e9}}));
    ASSERT_TRUE(options->calibration);
    EXPECT_DOUBLE_EQ(options->calibration->force_per_count, 1e-6);
    EXPECT_DOUBLE_EQ(options->calibration->torque_per_count, 1e-9);
    EXPECT_THAT(readOptions(request({{"counts_per_force", 1e6}})).error().message,
                HasSubstr("counts_per_torque: missing"));
}

TEST(NetftDriver, TellsThatCountsAreMissingAndThatTheOthersAreWrong) {
    const auto torque_only = readOptions(request({{"counts_per_torque", 0.0}}));
    ASSERT_FALSE(torque_only);
    EXPECT_THAT(torque_only.error().message, HasSubstr("counts_per_force: missing"));
    EXPECT_THAT(torque_only.error().message, HasSubstr("counts_per_torque: 0 is not within"));
}

TEST(NetftDriver, TellsEverySettingThatIsWrong) {
    const auto device = device::netftDriver().open(
        request({{"rate", 9000.0}, {"force_unit", std::string("stone")}, {"prt", 1.0}}));
    ASSERT_FALSE(device);
    EXPECT_THAT(device.error().message, HasSubstr("rate: 9000 is not within 1 to 7000"));
    EXPECT_THAT(device.error().message, HasSubstr("unknown force unit 'stone'"));
    EXPECT_THAT(device.error().message, HasSubstr("prt: unknown"));
}

TEST(NetftDriver, OpensASensorThatIsNotThereYet) {
    auto device = device::netftDriver().open(request({{"http_port", 9.0}}));
    ASSERT_TRUE(device);
    ASSERT_NE(device->force_torque_sensor, nullptr);
    EXPECT_EQ(device->force_torque_sensor->sample().health, device::SafetyState::disconnected);
    EXPECT_EQ(device->force_torque_sensor->name(), "wrist");
}

}  // namespace
}  // namespace metier::netft_driver
