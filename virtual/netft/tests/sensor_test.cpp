#include "sensor.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace metier::virtual_netft {
namespace {

using ::testing::ElementsAre;

const motion::Wrench kLoad{{10.0, -20.0, 30.0}, {1.0, -2.0, 3.0}};

TEST(Sensor, GivesCountsOfItsUnits) {
    Sensor sensor({});
    EXPECT_THAT(sensor.read(kLoad).counts,
                ElementsAre(10'000'000, -20'000'000, 30'000'000, 1'000'000, -2'000'000, 3'000'000));
    Calibration imperial;
    imperial.force_unit = kForceUnits[2];
    imperial.torque_unit = kTorqueUnits[5];
    Sensor other(imperial);
    const auto counts = other.read(kLoad).counts;
    EXPECT_NEAR(counts[0], 10.0 / 4.4482216 * 1e6, 1.0);
    EXPECT_NEAR(counts[3], 1.0 / 0.1129848 * 1e6, 10.0);
}

TEST(Sensor, KnowsTheUnitsThatWeigh) {
    const auto sizeOf = [](std::span<const Unit> units, std::string_view name) {
        return std::ranges::find(units, name, &Unit::name)->size;
    };
    EXPECT_DOUBLE_EQ(sizeOf(kForceUnits, "kgf"), 9.80665);
    EXPECT_DOUBLE_EQ(sizeOf(kForceUnits, "gf"), 0.00980665);
    EXPECT_DOUBLE_EQ(sizeOf(kTorqueUnits, "kgf-cm"), 0.0980665);
}

TEST(Sensor, IsZeroAtTheBias) {
    Sensor sensor({});
    sensor.read(kLoad);
    sensor.setBias();
    EXPECT_THAT(sensor.read(kLoad).counts, ElementsAre(0, 0, 0, 0, 0, 0));
    EXPECT_EQ(sensor.read({}).counts[0], -10'000'000);
}

TEST(Sensor, TellsItsBiasByGauge) {
    Sensor sensor({});
    EXPECT_THAT(sensor.gaugeBias(), ElementsAre(0, 0, 0, 0, 0, 0));
    sensor.read({{65.0, -32.5, 0.0}, {0.0, 0.0, 5.0}});
    sensor.setBias();
    EXPECT_THAT(sensor.gaugeBias(), ElementsAre(32767, -16384, 0, 0, 0, 32767));
}

TEST(Sensor, TakesABiasByGauge) {
    Sensor sensor({});
    sensor.read(kLoad);
    sensor.setBias();
    sensor.setGaugeBias(0, 0);
    sensor.setGaugeBias(1, 32767);
    EXPECT_THAT(sensor.read(kLoad).counts, ElementsAre(10'000'000, -85'000'000, 0, 0, 0, 0));
}

TEST(Sensor, IsSaturatedBeyondItsRange) {
    Sensor sensor({});
    EXPECT_EQ(sensor.read(kLoad).status, 0U);
    const auto reading = sensor.read({{0.0, 66.0, 0.0}, {0.0, 0.0, 0.0}});
    EXPECT_EQ(reading.status, 0x80020000U);
    EXPECT_EQ(reading.counts[1], 65'000'000);
}

TEST(Sensor, KeepsAWarningUntilTheLatchIsReset) {
    Sensor sensor({});
    sensor.setStatus(status::kMonitorLatched);
    EXPECT_EQ(sensor.read({}).status, 0x80010000U);
    sensor.resetLatch();
    EXPECT_EQ(sensor.read({}).status, 0U);
    sensor.setStatus(status::kTemperature);
    sensor.resetLatch();
    EXPECT_EQ(sensor.read({}).status, 0x80000004U);
}

TEST(Sensor, HasTheNoiseItIsGiven) {
    Calibration noisy;
    noisy.force_noise = 0.05;
    Sensor sensor(noisy);
    double squares = 0.0;
    constexpr int kSamples = 2000;
    for (int i = 0; i < kSamples; ++i) {
        const double force = sensor.read({}).counts[0] / 1e6;
        squares += force * force;
    }
    EXPECT_NEAR(std::sqrt(squares / kSamples), 0.05, 0.005);
}

}  // namespace
}  // namespace metier::virtual_netft
