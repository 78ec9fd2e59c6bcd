#include "metier/iiwa_driver/wire.hpp"

#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "commands.hpp"
#include "metier/base/testing/allocation_count.hpp"

namespace metier::iiwa_driver {
namespace {

using ::testing::HasSubstr;

std::string hex(std::span<const std::byte> bytes) {
    std::string text;
    for (const auto byte : bytes) {
        text += fmt::format("{:02x}", std::to_integer<int>(byte));
    }
    return text;
}

std::vector<std::byte> unhex(const std::string& text) {
    std::vector<std::byte> bytes;
    for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
        bytes.push_back(static_cast<std::byte>(std::stoi(text.substr(i, 2), nullptr, 16)));
    }
    return bytes;
}

std::string zeros(int numbers) {
    return std::string(static_cast<std::size_t>(numbers) * 8, '0');
}

std::string encoded(const Command& command) {
    return hex(encode(command, Precision::float32).bytes());
}

TEST(IiwaWire, AJointMoveIsItsCodeAndSevenAnglesBigEndian) {
    const auto command =
        moveJoints(device::JointArray(std::array{0.0, 0.5, -0.5, 1.0, -1.0, 2.0, -2.0}));
    EXPECT_EQ(encoded(command),
              "42cc0000"
              "00000000"
              "3f000000"
              "bf000000"
              "3f800000"
              "bf800000"
              "40000000"
              "c0000000");
}

TEST(IiwaWire, DoublePrecisionDoublesTheBytes) {
    const auto bytes = encode(jointVelocity(0.25), Precision::float64);
    EXPECT_EQ(hex(bytes.bytes()),
              "4069200000000000"
              "3fd0000000000000" +
                  zeros(12));
}

TEST(IiwaWire, APoseIsSentInMillimetresWithTheAngleAboutZFirst) {
    EXPECT_EQ(encoded(movePose({0.5, -0.25, 1.0, 0.5, 1.0, -0.5})),
              "42ce0000"
              "43fa0000"
              "c37a0000"
              "447a0000"
              "bf000000"
              "3f800000"
              "3f000000"
              "00000000");
}

TEST(IiwaWire, VelocitiesOfLinesAreSentInMillimetres) {
    EXPECT_EQ(encoded(lineVelocity(0.25)),
              "434c0000"
              "437a0000" +
                  zeros(6));
    EXPECT_EQ(encoded(lineAcceleration(1.0)),
              "434d0000"
              "447a0000" +
                  zeros(6));
}

TEST(IiwaWire, SettingsHaveTheirNumbers) {
    EXPECT_EQ(encoded(askState()), zeros(8));
    EXPECT_EQ(encoded(cancel()), "42ca0000" + zeros(7));
    EXPECT_EQ(encoded(chooseInterface(Interface::servo)),
              "43970000"
              "42000000" +
                  zeros(6));
    EXPECT_EQ(encoded(chooseMotionType(MotionType::line)),
              "43978000"
              "41b00000" +
                  zeros(6));
    EXPECT_EQ(encoded(positionControl()),
              "43980000"
              "42240000" +
                  zeros(6));
    EXPECT_EQ(encoded(asynchronousExecution()),
              "43988000"
              "424c0000" +
                  zeros(6));
    EXPECT_EQ(encoded(attachTool(2)),
              "43c80000"
              "40000000" +
                  zeros(6));
}

TEST(IiwaWire, AForceThatIsNotWatchedIsNaNInBothPlaces) {
    device::ForceCondition condition;
    condition.force[2] = 20.0;
    const auto command = forceCondition(condition, 10.0);
    EXPECT_EQ(command.code, Code::force_condition);
    EXPECT_TRUE(std::isnan(command.arguments[0]) && std::isnan(command.arguments[3]));
    EXPECT_EQ(command.arguments[2], 20.0);
    EXPECT_EQ(command.arguments[5], 10.0);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_TRUE(std::isnan(forceConditionOff().arguments[i]));
    }
}

/// A state as bytes: executed; joints 0.5; velocities 0.25; joint torques 1; X 500, Y -250, Z 1000,
/// A 0.5, B 1, C -0.5; force 1 2 -2; torque 0.5 ... ; error -10, condition met, ready, not active.
std::string goldenState() {
    std::string text = "3f800000";
    for (const auto* value : {"3f000000", "3e800000", "3f800000"}) {
        for (int axis = 0; axis < 7; ++axis) {
            text += value;
        }
    }
    text +=
        "43fa0000"
        "c37a0000"
        "447a0000"
        "3f000000"
        "3f800000"
        "bf000000";
    text +=
        "3f800000"
        "40000000"
        "c0000000"
        "3f000000"
        "3f000000"
        "bf000000";
    return text +
           "c1200000"
           "3f800000"
           "3f800000"
           "00000000";
}

TEST(IiwaWire, AStateIsReadIntoSiUnits) {
    const auto state = parseState(unhex(goldenState()), Precision::float32);
    ASSERT_TRUE(state);
    EXPECT_TRUE(state->executed);
    EXPECT_EQ(state->position[6], 0.5);
    EXPECT_EQ(state->velocity[0], 0.25);
    EXPECT_EQ(state->joint_torque[3], 1.0);
    EXPECT_EQ(state->pose, (Frame{0.5, -0.25, 1.0, -0.5, 1.0, 0.5}));
    EXPECT_EQ(state->force, (std::array{1.0, 2.0, -2.0}));
    EXPECT_EQ(state->torque, (std::array{0.5, 0.5, -0.5}));
    EXPECT_EQ(state->last_error, -10);
    EXPECT_TRUE(state->force_condition_met);
    EXPECT_TRUE(state->ready);
    EXPECT_FALSE(state->active);
}

TEST(IiwaWire, AStateInDoublePrecisionIsReadToo) {
    std::string text;
    for (const double number : {1.0, 0.125}) {
        text += fmt::format("{:016x}", std::bit_cast<std::uint64_t>(number));
    }
    text += std::string(36 * 16, '0');
    const auto state = parseState(unhex(text), Precision::float64);
    ASSERT_TRUE(state);
    EXPECT_TRUE(state->executed);
    EXPECT_EQ(state->position[0], 0.125);
}

TEST(IiwaWire, AStateOfAnotherLengthIsRefusedWithAHintOnThePrecision) {
    for (const std::size_t size : {0U, 4U, 151U, 153U, 304U}) {
        const auto state = parseState(std::vector<std::byte>(size), Precision::float32);
        ASSERT_FALSE(state);
        EXPECT_THAT(toError(state.error()).message, HasSubstr("precision")) << size;
    }
}

std::string withNumber(std::size_t element, float value) {
    auto text = goldenState();
    return text.replace(element * 8, 8, fmt::format("{:08x}", std::bit_cast<std::uint32_t>(value)));
}

TEST(IiwaWire, PositionsVelocitiesAndPoseMustBeFiniteAndPossible) {
    for (std::size_t element = 1; element < 28; ++element) {
        if (element >= 15 && element < 22) {
            continue;  // torques
        }
        for (const float value : {std::nanf(""), std::numeric_limits<float>::infinity(), 1e9F}) {
            const auto state = parseState(unhex(withNumber(element, value)), Precision::float32);
            ASSERT_FALSE(state) << element;
            EXPECT_EQ(state.error().element, element);
            EXPECT_EQ(toError(state.error()).code, Errc::connection_lost);
        }
    }
}

TEST(IiwaWire, ForcesNeedNotBeKnown) {
    const auto state = parseState(unhex(withNumber(28, std::nanf(""))), Precision::float32);
    ASSERT_TRUE(state);
    EXPECT_TRUE(std::isnan(state->force[0]));
}

TEST(IiwaWire, AFlagIsNothingButZeroOrOne) {
    for (const std::size_t element : {0U, 35U, 36U, 37U}) {
        for (const float value : {-1.0F, 0.5F, 2.0F, std::nanf("")}) {
            EXPECT_FALSE(parseState(unhex(withNumber(element, value)), Precision::float32));
        }
    }
}

TEST(IiwaWire, NeitherReadingNorWritingAllocates) {
    const auto bytes = unhex(goldenState());
    const auto before = allocationCount();
    const auto state = parseState(bytes, Precision::float32);
    const auto broken = parseState(std::span(bytes).first(20), Precision::float32);
    const auto command = encode(cancel(), Precision::float32);
    EXPECT_EQ(allocationCount(), before);
    EXPECT_TRUE(state && !broken && command.bytes().size() == 32);
}

}  // namespace
}  // namespace metier::iiwa_driver
