#include "messages.hpp"

#include <gmock/gmock.h>

#include <array>
#include <limits>
#include <string>

#include "wire.hpp"

namespace metier::wsg50_driver::testing {
namespace {

using ::testing::HasSubstr;

Bytes sent(Command command) {
    const auto span = command.bytes();
    return {span.begin(), span.end()};
}

TEST(Messages, CommandsAreInMillimetresOnTheWire) {
    EXPECT_EQ(sent(graspCommand(0.012, 0.034)), frame(0x25, f32(12) + f32(34)));
    EXPECT_EQ(sent(releaseCommand(0.11, 0.42)), frame(0x26, f32(110) + f32(420)));
    EXPECT_EQ(sent(accelerationCommand(2.5)), frame(0x30, f32(2500)));
    EXPECT_EQ(sent(forceLimitCommand(40)), frame(0x32, f32(40)));
}

TEST(Messages, PrePositionIsAbsoluteAndStopsOnABlock) {
    EXPECT_EQ(sent(positionCommand(0.034, 0.056)),
              bytes({0xAA, 0xAA, 0xAA, 0x21, 9, 0, 2}) + f32(34) + f32(56) + bytes({0x95, 0x56}));
}

TEST(Messages, UpdatesAreAskedForEveryPeriod) {
    EXPECT_EQ(sent(updateCommand(CommandId::grasping_state, std::chrono::milliseconds(0x4E0E))),
              bytes({0xAA, 0xAA, 0xAA, 0x41, 3, 0, 0x01, 0x0E, 0x4E, 0x15, 0xB9}));
}

TEST(Messages, HomingGoesInTheDefaultDirection) {
    EXPECT_EQ(sent(homeCommand()), bytes({0xAA, 0xAA, 0xAA, 0x20, 1, 0, 0, 0x8F, 0x83}));
}

TEST(Messages, AReplyHasAStatusAndData) {
    const auto payload = bytes({26, 0, 7});
    const auto reply = parseReply({0x25, payload});
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->id, CommandId::grasp);
    EXPECT_EQ(reply->status, Status::pending);
    EXPECT_EQ(reply->data.size(), 1U);
    const auto shorter = bytes({26});
    EXPECT_FALSE(parseReply({0x25, shorter}));
    EXPECT_FALSE(parseReply({0x25, {}}));
}

TEST(Messages, AStatusIsDescribedByNameAndNumber) {
    EXPECT_EQ(describe(Status::blocked), "axis blocked (status 29)");
    EXPECT_EQ(describe(static_cast<Status>(30)), "file exists (status 30)");
    EXPECT_EQ(describe(static_cast<Status>(31)), "unknown (status 31)");
    EXPECT_EQ(describe(static_cast<Status>(65535)), "unknown (status 65535)");
}

TEST(Messages, TheSystemStateTellsFaultsByName) {
    const auto state = parseSystemState(u32(1U | 1U << 1U | 1U << 12U | 1U << 15U));
    ASSERT_TRUE(state);
    EXPECT_TRUE(state->referenced());
    EXPECT_TRUE(state->moving());
    EXPECT_TRUE(state->fault());
    EXPECT_EQ(state->faultText(), "fast stop, power fault");
}

TEST(Messages, ATemperatureWarningIsNoFault) {
    EXPECT_FALSE(parseSystemState(u32(1U << 13U))->fault());
    EXPECT_FALSE(parseSystemState(u32(1U << 18U))->fault());
    for (const unsigned bit : {12U, 14U, 15U, 16U, 17U}) {
        EXPECT_TRUE(parseSystemState(u32(1U << bit))->fault()) << bit;
    }
}

TEST(Messages, ValuesBecomeSi) {
    EXPECT_NEAR(*parseWidth(f32(42.5F)), 0.0425, 1e-9);
    EXPECT_NEAR(*parseForce(f32(-3.0F)), -3.0, 1e-9);
    EXPECT_EQ(*parseGraspingState(bytes({4})), GraspingState::holding);
}

TEST(Messages, RefusesValuesThatAreNone) {
    EXPECT_FALSE(parseWidth(f32(std::numeric_limits<float>::quiet_NaN())));
    EXPECT_FALSE(parseWidth(f32(std::numeric_limits<float>::infinity())));
    EXPECT_FALSE(parseForce(f32(1e30F)));
    EXPECT_FALSE(parseForce(bytes({1, 2, 3})));
    EXPECT_FALSE(parseForce(bytes({1, 2, 3, 4, 5})));
    EXPECT_FALSE(parseSystemState({}));
    EXPECT_FALSE(parseGraspingState(bytes({8})));
    EXPECT_FALSE(parseGraspingState({}));
}

Bytes limitValues(std::initializer_list<float> values) {
    Bytes data;
    for (const float value : values) {
        data = data + f32(value);
    }
    return data;
}

TEST(Messages, LimitsBecomeSi) {
    const auto limits = parseLimits(limitValues({110, 5, 420, 100, 5000, 5, 80, 120}));
    ASSERT_TRUE(limits);
    EXPECT_NEAR(limits->stroke, 0.11, 1e-9);
    EXPECT_NEAR(limits->max_speed, 0.42, 1e-9);
    EXPECT_NEAR(limits->max_acceleration, 5.0, 1e-9);
    EXPECT_EQ(limits->max_force, 80.0) << "without overdrive";
}

TEST(Messages, RefusesLimitsThatMakeNoSense) {
    const auto nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT(parseLimits(limitValues({0, 5, 420, 100, 5000, 5, 80, 120})).error().message,
                HasSubstr("width"));
    EXPECT_THAT(parseLimits(limitValues({110, 500, 420, 100, 5000, 5, 80, 120})).error().message,
                HasSubstr("speed"));
    EXPECT_FALSE(parseLimits(limitValues({110, 5, 420, 100, 5000, nan, 80, 120})));
    EXPECT_FALSE(parseLimits(limitValues({110, 5, 420})));
}

TEST(Messages, RefusesLimitsWithoutRoomBetweenThem) {
    struct Case {
        std::initializer_list<float> values;
        const char* problem = nullptr;
    };
    for (const auto& [values, problem] :
         {Case{{-110, 5, 420, 100, 5000, 5, 80, 120}, "width from 0 to -0.11"},
          Case{{110, 420, 420, 100, 5000, 5, 80, 120}, "speed from 0.42 to 0.42"},
          Case{{110, -5, 420, 100, 5000, 5, 80, 120}, "speed from -0.005 to 0.42"},
          Case{{110, 5, 420, 6000, 5000, 5, 80, 120}, "acceleration from 6 to 5"},
          Case{{110, 5, 420, 100, 5000, 80, 80, 120}, "force from 80 to 80"},
          Case{{110, 5, 420, 100, 5000, 5, 2e6F, 120}, "force from 5 to 2000000"}}) {
        const auto limits = parseLimits(limitValues(values));
        ASSERT_FALSE(limits) << problem;
        EXPECT_EQ(limits.error().code, Errc::invalid_argument);
        EXPECT_EQ(limits.error().message, std::string("limits: ") + problem);
    }
    const auto widest = parseLimits(limitValues({110, 0, 420, 0, 5000, 0, 1e6F, 120}));
    ASSERT_TRUE(widest);
    EXPECT_EQ(widest->min_speed, 0.0);
    EXPECT_EQ(widest->max_force, 1e6);
}

TEST(Messages, TakesValuesUpToAMillion) {
    EXPECT_EQ(*parseForce(f32(1e6F)), 1e6);
    EXPECT_EQ(*parseForce(f32(-1e6F)), -1e6);
    EXPECT_EQ(parseForce(f32(1.1e6F)).error().code, Errc::invalid_argument);
    EXPECT_EQ(parseForce(f32(-1.1e6F)).error().code, Errc::invalid_argument);
}

TEST(Messages, GraspingStatesHaveNames) {
    const std::array names{"idle",    "grasping",  "no part found", "part lost",
                           "holding", "releasing", "positioning",   "error"};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto state = parseGraspingState(bytes({static_cast<int>(i)}));
        ASSERT_TRUE(state) << i;
        EXPECT_EQ(toString(*state), names.at(i));
    }
}

TEST(Messages, AStatusHasTwoBytes) {
    const auto payload = bytes({0x02, 0x01});
    EXPECT_EQ(static_cast<int>(parseReply({0x25, payload})->status), 0x0102);
}

}  // namespace
}  // namespace metier::wsg50_driver::testing
