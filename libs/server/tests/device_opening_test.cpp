#include "host/device_opening.hpp"

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
    auto first = open(locked(7123));
    ASSERT_TRUE(first) << first.error().message;
    const auto second = open(locked(7123));
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::already_exists);
    EXPECT_THAT(second.error().message,
                AllOf(HasSubstr("hand: the controller locked at 127.0.0.1, port 7123"),
                      HasSubstr(std::to_string(getpid()))));
    EXPECT_TRUE(open(locked(7124))) << "another device behind the same address";
    first->owner.reset();
    EXPECT_TRUE(open(locked(7123)));
}

TEST(Device, IsTheSameByEachNameOfItsHost) {
    const auto first = open(locked(7125, "localhost"));
    ASSERT_TRUE(first) << first.error().message;
    const auto second = open(locked(7125, "127.0.0.1"));
    const auto third = open(locked(7125, "::1"));
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

}  // namespace
}  // namespace metier::server::testing
