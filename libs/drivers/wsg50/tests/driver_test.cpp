#include <gmock/gmock.h>

#include "metier/base/testing/allocation_count.hpp"
#include "talk.hpp"
#include "wsg50_gripper.hpp"

namespace metier::device {
Driver wsg50Driver();
}

namespace metier::wsg50_driver::testing {
namespace {

using ::testing::HasSubstr;

device::OpenRequest request(std::map<std::string, cell::Settings::Value> values) {
    return {.name = "tool",
            .address = "127.0.0.1",
            .settings = cell::Settings("cell.toml:3: driver", std::move(values))};
}

TEST(Wsg50Driver, NeedsNoSettings) {
    const auto options = readOptions(request({}));
    ASSERT_TRUE(options);
    EXPECT_EQ(options->port, 1000);
    EXPECT_EQ(options->conversation.update_period.count(), 20);
    EXPECT_EQ(options->conversation.silence_periods, 3);
    EXPECT_FALSE(options->conversation.acknowledge);
    EXPECT_FALSE(options->conversation.home);
    EXPECT_FALSE(options->force);
}

TEST(Wsg50Driver, TakesItsSettings) {
    const auto options = readOptions(request({{"port", 1001.0},
                                              {"update_period", 0.05},
                                              {"silence_periods", 5.0},
                                              {"speed", 0.2},
                                              {"grasp_speed", 0.03},
                                              {"part_width", 0.04},
                                              {"force", 30.0},
                                              {"open_width", 0.09},
                                              {"acceleration", 1.5},
                                              {"motion_timeout", 5.0},
                                              {"acknowledge_on_connect", true},
                                              {"home_on_connect", true}}));
    ASSERT_TRUE(options) << options.error().message;
    EXPECT_EQ(options->port, 1001);
    EXPECT_EQ(options->conversation.update_period.count(), 50);
    EXPECT_EQ(options->conversation.motion_timeout.count(), 5000);
    EXPECT_TRUE(options->conversation.home);
    EXPECT_EQ(options->force, 30.0);
    EXPECT_EQ(options->open_width, 0.09);
}

TEST(Wsg50Driver, TellsEverySettingThatIsWrong) {
    const auto device =
        device::wsg50Driver().open(request({{"speed", 3.0}, {"sped", 1.0}, {"force", true}}));
    ASSERT_FALSE(device);
    EXPECT_EQ(device.error().code, Errc::invalid_argument);
    EXPECT_THAT(device.error().message, HasSubstr("speed: 3 is not within 0.005 to 0.42"));
    EXPECT_THAT(device.error().message, HasSubstr("sped: unknown"));
    EXPECT_THAT(device.error().message, HasSubstr("force: is not a number"));
}

TEST(Wsg50Driver, OpensAGripperThatIsNotThereYet) {
    auto device = device::wsg50Driver().open(request({{"port", 9.0}}));
    ASSERT_TRUE(device);
    ASSERT_NE(device->gripper, nullptr);
    EXPECT_EQ(device->arm, nullptr);
    EXPECT_EQ(device->gripper->state().safety, device::SafetyState::disconnected);
    EXPECT_THAT(device->gripper->safety().text, HasSubstr("tool: "));
}

TEST(Conversation, TakesUpdatesWithoutAllocating) {
    Talk talk;
    talk.start();
    const auto frames = systemState(kReferenced) + graspingState(kHolding) + width(30) + force(20);
    const auto before = allocationCount();
    for (int i = 0; i < 1000; ++i) {
        talk.hear(frames);
        talk.wait(std::chrono::milliseconds(1));
    }
    EXPECT_EQ(allocationCount(), before);
    EXPECT_FALSE(talk.error);
}

}  // namespace
}  // namespace metier::wsg50_driver::testing
