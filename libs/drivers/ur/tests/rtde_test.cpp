#include "rtde.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "metier/base/testing/allocation_count.hpp"
#include "wire_bytes.hpp"

namespace metier::ur_driver::rtde {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

StreamBuffer bufferOf(const std::vector<std::byte>& bytes) {
    StreamBuffer buffer(2 * kMaxPackageSize);
    std::copy(bytes.begin(), bytes.end(), buffer.space().begin());
    buffer.filled(bytes.size());
    return buffer;
}

RecipeReply allFound(const OutputRecipe& recipe, std::uint8_t id = 1) {
    RecipeReply reply{id, {}};
    for (const auto& name : recipe.names()) {
        const bool vector = name.find("target_q") == 0 || name.find("actual_") == 0;
        const bool number = name == "timestamp" || name.find("speed") != std::string::npos;
        reply.types.emplace_back(vector                    ? "VECTOR6D"
                                 : number                  ? "DOUBLE"
                                 : name == "runtime_state" ? "UINT32"
                                                           : "INT32");
    }
    return reply;
}

OutputRecipe agreed() {
    OutputRecipe recipe(24);
    EXPECT_EQ(recipe.take(allFound(recipe)), true);
    return recipe;
}

std::vector<std::byte> dataOf(double first_velocity = 0.5) {
    const std::array target{1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
    const std::array actual{0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
    const std::array velocity{first_velocity, 0.0, 0.0, 0.0, 0.0, -0.5};
    return WireBytes()
        .u8(1)
        .f64(123.456)
        .f64s(target)
        .f64s(actual)
        .f64s(velocity)
        .i32(-1)
        .i32(3)
        .u32(2)
        .i32(77)
        .i32(-5)
        .f64(0.5)
        .f64(0.25)
        .bytes();
}

TEST(Rtde, RequestsAreTheBytesOfTheDocument) {
    EXPECT_EQ(requestProtocolVersion(), fromHex("00 05 56 00 02"));
    EXPECT_EQ(request(PackageType::get_controller_version), fromHex("00 03 76"));
    EXPECT_EQ(request(PackageType::start), fromHex("00 03 53"));
    EXPECT_EQ(request(PackageType::pause), fromHex("00 03 50"));
    EXPECT_EQ(setupOutputs(125.0, {"a", "bc"}),
              fromHex("00 0F 4F 40 5F 40 00 00 00 00 00 61 2C 62 63"));
    EXPECT_EQ(setupInputs({"a", "bc"}), fromHex("00 07 49 61 2C 62 63"));
}

TEST(Rtde, ASetPointIsTheBytesOfTheDocument) {
    const Setpoint setpoint{258, -2, {1.0, -1.0, 0.0, 0.5, 2.0, -0.25}};
    const auto package = setpointPackage(7, setpoint);
    EXPECT_EQ(std::vector(package.begin(), package.end()),
              fromHex("00 3C 55 07 00 00 01 02 FF FF FF FE "
                      "3F F0 00 00 00 00 00 00 BF F0 00 00 00 00 00 00 "
                      "00 00 00 00 00 00 00 00 3F E0 00 00 00 00 00 00 "
                      "40 00 00 00 00 00 00 00 BF D0 00 00 00 00 00 00"));
}

TEST(Rtde, ASetPointGoesToTheRegistersOfItsBase) {
    EXPECT_THAT(setpointNames(24),
                ElementsAre("input_int_register_24", "input_int_register_25",
                            "input_double_register_24", "input_double_register_25",
                            "input_double_register_26", "input_double_register_27",
                            "input_double_register_28", "input_double_register_29"));
}

TEST(Rtde, FindsPackagesInAStreamHoweverItIsCut) {
    const auto stream = WireBytes()
                            .append(rtdePackage('S', fromHex("01")))
                            .append(rtdePackage('U', fromHex("01 02 03")))
                            .bytes();
    StreamBuffer buffer(16);
    std::vector<std::size_t> sizes;
    for (const std::byte byte : stream) {
        buffer.space()[0] = byte;
        buffer.filled(1);
        const auto package = firstPackage(buffer);
        ASSERT_TRUE(package);
        if (*package) {
            sizes.push_back((*package)->payload.size());
            buffer.consume(kHeaderSize + (*package)->payload.size());
        }
    }
    EXPECT_THAT(sizes, ElementsAre(1, 3));
}

TEST(Rtde, RefusesAPackageThatIsShorterThanItsHeader) {
    EXPECT_FALSE(firstPackage(bufferOf(fromHex("00 02 55"))));
    EXPECT_FALSE(firstPackage(bufferOf(fromHex("00 00 55"))));
    EXPECT_EQ(firstPackage(bufferOf(fromHex("00 02"))).value(), std::nullopt);
}

TEST(Rtde, ReadsAcceptance) {
    EXPECT_EQ(parseAccepted(fromHex("01")), true);
    EXPECT_EQ(parseAccepted(fromHex("00")), false);
    EXPECT_FALSE(parseAccepted({}));
    EXPECT_FALSE(parseAccepted(fromHex("01 01")));
}

TEST(Rtde, ReadsTheControllersVersion) {
    const auto version =
        parseControllerVersion(fromHex("00 00 00 03 00 00 00 0F 00 00 00 08 00 01 9F 63"));
    ASSERT_TRUE(version);
    EXPECT_EQ(version->major, 3U);
    EXPECT_EQ(version->minor, 15U);
    EXPECT_EQ(version->bugfix, 8U);
    EXPECT_EQ(version->build, 106339U);
    EXPECT_FALSE(parseControllerVersion(fromHex("00 00 00 03")));
}

TEST(Rtde, ReadsTextMessages) {
    const auto text = parseTextMessage(fromHex("02 48 69 03 61 0A 62 01"));
    ASSERT_TRUE(text);
    EXPECT_EQ(text->message, "Hi");
    EXPECT_EQ(text->source, "a b");
    EXPECT_EQ(text->level, TextMessage::Level::error);
    EXPECT_FALSE(parseTextMessage(fromHex("09 48 69")));
    EXPECT_FALSE(parseTextMessage(fromHex("00 00 09")));
    EXPECT_FALSE(parseTextMessage({}));
}

TEST(Rtde, ReadsRecipes) {
    const auto reply = parseRecipeReply(WireBytes().u8(4).text("DOUBLE,NOT_FOUND").bytes());
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->id, 4);
    EXPECT_THAT(reply->types, ElementsAre("DOUBLE", "NOT_FOUND"));
    EXPECT_FALSE(parseRecipeReply({}));
}

TEST(OutputRecipe, DecodesADataPackage) {
    const auto state = agreed().decode(dataOf());
    ASSERT_TRUE(state) << state.error().message;
    EXPECT_DOUBLE_EQ(state->timestamp, 123.456);
    EXPECT_DOUBLE_EQ(state->target_q[5], 6.0);
    EXPECT_DOUBLE_EQ(state->actual_q[0], 0.1);
    EXPECT_DOUBLE_EQ(state->actual_qd[5], -0.5);
    EXPECT_EQ(state->robot_mode, RobotMode::no_controller);
    EXPECT_EQ(state->safety_mode, SafetyMode::protective_stop);
    EXPECT_EQ(state->runtime_state, RuntimeState::playing);
    EXPECT_EQ(state->script_token, 77);
    EXPECT_EQ(state->script_counter, -5);
    EXPECT_DOUBLE_EQ(state->speed_scaling, 0.5);
    EXPECT_DOUBLE_EQ(state->target_speed_fraction, 0.25);
}

TEST(OutputRecipe, DecodesWithoutAllocating) {
    const auto recipe = agreed();
    const auto data = dataOf();
    const auto before = allocationCount();
    const bool decoded = recipe.decode(data).has_value();
    EXPECT_EQ(allocationCount() - before, 0U);
    EXPECT_TRUE(decoded);
}

TEST(OutputRecipe, RefusesDataOfAnotherRecipeOrSizeOrThatIsNoNumber) {
    const auto recipe = agreed();
    auto other = dataOf();
    other[0] = std::byte{2};
    EXPECT_THAT(recipe.decode(other).error().message, HasSubstr("of recipe 2"));
    auto shorter = dataOf();
    shorter.pop_back();
    EXPECT_FALSE(recipe.decode(shorter));
    EXPECT_FALSE(recipe.decode({}));
    EXPECT_THAT(recipe.decode(dataOf(std::nan(""))).error().message, HasSubstr("not finite"));
}

/// dataOf() with another number at some byte.
std::vector<std::byte> dataWith(std::size_t at, double number) {
    auto data = dataOf();
    const auto bytes = WireBytes().f64(number).bytes();
    std::copy(bytes.begin(), bytes.end(), data.begin() + static_cast<std::ptrdiff_t>(at));
    return data;
}

// Offset of the numbers in dataOf(): behind the id of the recipe.
constexpr std::size_t kTarget = 1 + 8;
constexpr std::size_t kActual = kTarget + 48;
constexpr std::size_t kVelocity = kActual + 48;
constexpr std::size_t kScaling = kVelocity + 48 + 20;

TEST(OutputRecipe, RefusesEveryNumberThatIsNotFinite) {
    std::vector<std::size_t> places{1, kScaling, kScaling + 8};
    for (std::size_t axis = 0; axis < 6; ++axis) {
        for (const auto part : {kTarget, kActual, kVelocity}) {
            places.push_back(part + 8 * axis);
        }
    }
    for (const auto at : places) {
        for (const double number : {std::nan(""), -std::numeric_limits<double>::infinity()}) {
            const auto state = agreed().decode(dataWith(at, number));
            ASSERT_FALSE(state) << at;
            EXPECT_THAT(state.error().message, HasSubstr("not finite")) << at;
        }
        EXPECT_TRUE(agreed().decode(dataWith(at, 0.0))) << at;
    }
}

TEST(OutputRecipe, RefusesJointsThatNoArmCanHave) {
    const auto judge = [](std::size_t at, double most) {
        for (const double number : {1.001 * most, -1.001 * most}) {
            const auto state = agreed().decode(dataWith(at, number));
            ASSERT_FALSE(state) << at;
            EXPECT_THAT(state.error().message, HasSubstr("no arm has")) << at;
        }
        EXPECT_TRUE(agreed().decode(dataWith(at, most))) << at;
        EXPECT_TRUE(agreed().decode(dataWith(at, -most))) << at;
    };
    for (std::size_t axis = 0; axis < 6; ++axis) {
        judge(kTarget + 8 * axis, 1000.0);
        judge(kActual + 8 * axis, 1000.0);
        judge(kVelocity + 8 * axis, 100.0);
    }
}

TEST(OutputRecipe, AsksForSafetyModeWhereSafetyStatusIsUnknown) {
    OutputRecipe recipe(24);
    auto reply = allFound(recipe, 0);
    reply.types[5] = "NOT_FOUND";
    EXPECT_EQ(recipe.take(reply), false);
    EXPECT_EQ(recipe.names()[5], "safety_mode");
    EXPECT_EQ(recipe.take(allFound(recipe)), true);
    reply = allFound(recipe, 0);
    reply.types[5] = "NOT_FOUND";
    EXPECT_THAT(recipe.take(reply).error().message, HasSubstr("does not offer safety_mode"));
}

TEST(OutputRecipe, LeavesOutWhatIsNotNeeded) {
    OutputRecipe recipe(24);
    auto reply = allFound(recipe, 0);
    reply.types[9] = "NOT_FOUND";
    EXPECT_EQ(recipe.take(reply), false);
    EXPECT_EQ(recipe.names().size(), 10U);
    EXPECT_EQ(recipe.take(allFound(recipe)), true);
    auto data = dataOf();
    data.erase(data.end() - 8, data.end());  // one speed
    ASSERT_TRUE(recipe.decode(data));
    EXPECT_DOUBLE_EQ(recipe.decode(data)->speed_scaling, 1.0);
}

TEST(OutputRecipe, RefusesAnswersThatDoNotFit) {
    OutputRecipe recipe(24);
    EXPECT_FALSE(recipe.take({1, {"DOUBLE"}}));
    EXPECT_FALSE(recipe.take(allFound(recipe, 0)));
    auto reply = allFound(recipe);
    reply.types[1] = "BOOL";
    EXPECT_THAT(recipe.take(reply).error().message,
                HasSubstr("offers target_q as BOOL, not as VECTOR6D"));
    EXPECT_THAT(OutputRecipe(3).names(), testing::Contains("output_int_register_4"));
}

TEST(Setpoint, RegistersMustBeFreeAndOfTheirType) {
    const RecipeReply good{
        3, {"INT32", "INT32", "DOUBLE", "DOUBLE", "DOUBLE", "DOUBLE", "DOUBLE", "DOUBLE"}};
    EXPECT_TRUE(checkSetpointReply(good, 24));
    auto bad = good;
    bad.types[7] = "IN_USE";
    EXPECT_EQ(checkSetpointReply(bad, 24).error().code, Errc::resource_unavailable);
    bad.types[7] = "NOT_FOUND";
    EXPECT_EQ(checkSetpointReply(bad, 24).error().code, Errc::not_supported);
    bad = good;
    bad.id = 0;
    EXPECT_FALSE(checkSetpointReply(bad, 24));
    bad.types.pop_back();
    EXPECT_EQ(checkSetpointReply(bad, 24).error().code, Errc::invalid_argument);
}

}  // namespace
}  // namespace metier::ur_driver::rtde
