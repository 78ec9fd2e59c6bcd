#include "host/device_opening.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <thread>

#include "fake_devices.hpp"

namespace metier::server::testing {
namespace {

using cell::DriverChoice;
using cell::Settings;
using ::testing::AllOf;
using ::testing::HasSubstr;

Result<device::OpenDevice> open(const DriverChoice& choice) {
    static const std::string kName = "hand";
    static const auto kDrivers = fakeDrivers();
    return openDevice(choice, {kName, kDrivers});
}

/// A port that no test of another process uses.
int ownPort(int number) {
    return 10'000 + getpid() % 10'000 * 5 + number;
}

DriverChoice locked(double port, const std::string& controller = "127.0.0.1") {
    return {.type = "locked",
            .controller = controller,
            .settings = Settings("cell", {{"port", Settings::Value(port)}})};
}

TEST(Device, IsOpenedByTheDriverOfItsType) {
    const auto device = open({.type = "gripper", .controller = "10.1.1.1", .settings = {}});
    ASSERT_TRUE(device) << device.error().message;
    EXPECT_NE(device->gripper, nullptr);
    EXPECT_EQ(lastRequest().name, "hand");
    EXPECT_EQ(lastRequest().address, "10.1.1.1");
}

TEST(Device, OfAnUnknownDriverIsRefusedWithThoseThatThereAre) {
    const auto device = open({.type = "abacus", .controller = "", .settings = {}});
    ASSERT_FALSE(device);
    EXPECT_EQ(device.error().code, Errc::invalid_argument);
    EXPECT_EQ(device.error().message,
              "hand: no driver of type \"abacus\"; there are: simulator, gripper, locked, sensor");
}

TEST(Device, IsRefusedWithSettingsThatItsDriverDoesNotKnow) {
    const DriverChoice choice{.type = "gripper",
                              .controller = "",
                              .settings = Settings("cell:7", {{"colour", Settings::Value(1.0)}})};
    const auto device = open(choice);
    ASSERT_FALSE(device);
    EXPECT_THAT(device.error().message, HasSubstr("cell:7.colour"));
}

TEST(Device, IsHadByOneServerAtATime) {
    auto first = open(locked(ownPort(0)));
    ASSERT_TRUE(first) << first.error().message;
    const auto second = open(locked(ownPort(0)));
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::already_exists);
    EXPECT_THAT(second.error().message,
                AllOf(HasSubstr(fmt::format("hand: the controller locked at 127.0.0.1, port {}",
                                            ownPort(0))),
                      HasSubstr(std::to_string(getpid()))));
    EXPECT_TRUE(open(locked(ownPort(1)))) << "another device behind the same address";
    first->owner.reset();
    EXPECT_TRUE(open(locked(ownPort(0))));
}

TEST(Device, IsTheSameByEachNameOfItsHost) {
    const auto first = open(locked(ownPort(2), "localhost"));
    ASSERT_TRUE(first) << first.error().message;
    const auto second = open(locked(ownPort(2), "127.0.0.1"));
    const auto third = open(locked(ownPort(2), "::1"));
    EXPECT_TRUE(!second || !third) << "localhost is one of the two";
}

TEST(Device, WithoutAPortOrAtAnyFreeOneIsHadByAnybody) {
    const auto first = open(locked(0));
    EXPECT_TRUE(open(locked(0)));
    const DriverChoice choice{.type = "gripper", .controller = "127.0.0.1", .settings = {}};
    const auto second = open(choice);
    EXPECT_TRUE(open(choice));
}

TEST(Device, IsNotWaitedForOnceItIsReady) {
    const auto device = open({.type = "gripper", .controller = "", .settings = {}});
    ASSERT_TRUE(device);
    const auto begun = std::chrono::steady_clock::now();
    awaitConnection(*device);
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(9));
}

TEST(Device, IsWaitedForUntilItsControllerAnswers) {
    const auto device = open({.type = "gripper", .controller = "", .settings = {}});
    ASSERT_TRUE(device);
    const auto gripper = lastGripper();
    gripper->become(device::SafetyState::disconnected);
    std::jthread answering([&gripper] {
        while (!gripper->isWatched()) {
            std::this_thread::yield();
        }
        gripper->become(device::SafetyState::normal);
    });
    awaitConnection(*device);
    EXPECT_EQ(gripper->safety().state, device::SafetyState::normal);
}

/// A sensor that becomes ready while it is asked for its state.
class SlowlySpeakingSensor final : public device::ForceTorqueSensor {
public:
    const std::string& name() const noexcept override { return name_; }
    device::WrenchSample sample() const noexcept override { return {}; }
    device::Safety safety() const override {
        callback_({});
        return {device::SafetyState::disconnected, "no answer yet", false};
    }
    Result<void> tare() override { return {}; }
    device::Registration onSafetyChange(SafetyCallback callback) override {
        callback_ = std::move(callback);
        return {};
    }

private:
    const std::string name_ = "slow";
    SafetyCallback callback_;
};

TEST(Device, IsNotWaitedForIfItBecomesReadyWhileItIsAsked) {
    SlowlySpeakingSensor sensor;
    device::OpenDevice device;
    device.force_torque_sensor = &sensor;
    const auto begun = std::chrono::steady_clock::now();
    awaitConnection(device);
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(9));
}

}  // namespace
}  // namespace metier::server::testing
