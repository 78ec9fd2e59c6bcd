#include "primary.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "wire_bytes.hpp"

namespace metier::ur_driver::primary {
namespace {

using testing::HasSubstr;

std::vector<std::byte> message(int kind, const std::vector<std::byte>& body) {
    return primaryPackage(
        20, WireBytes().u64(123).u8(0xfe).u8(static_cast<unsigned>(kind)).append(body).bytes());
}

std::vector<std::byte> kinematics(double first_theta) {
    WireBytes body;
    for (unsigned i = 0; i < 6; ++i) {
        body.u32(i + 1);
    }
    body.f64s(std::array{first_theta, 0.0, 0.0, 0.0, 0.0, 0.0});
    body.f64s(std::array{0.0, -0.425, -0.39225, 0.0, 0.0, 0.0});
    body.f64s(std::array{0.089159, 0.0, 0.0, 0.10915, 0.09465, 0.0823});
    body.f64s(std::array{1.5708, 0.0, 0.0, 1.5708, -1.5708, 0.0}).u32(0);
    return primaryPackage(5, body.bytes());
}

std::vector<std::byte> configuration() {
    WireBytes body;
    for (int i = 0; i < 6; ++i) {
        body.f64(-6.3355 + i).f64(6.3355);
    }
    for (int i = 0; i < 6; ++i) {
        body.f64(3.3416).f64(40.0 - i);
    }
    body.f64s(std::array{1.0472, 1.3963, 0.25, 1.2, 0.5}).f64s(std::array<double, 24>{});
    body.i32(16777216).i32(3).i32(1).i32(0);
    return primaryPackage(6, body.bytes());
}

std::vector<std::byte> robotMode() {
    const auto body =
        WireBytes().u64(1).append(fromHex("01 01 01 00 01 01 00 07 00")).f64(1).f64(1).f64(1).u8(0);
    return primaryPackage(0, body.bytes());
}

std::vector<std::byte> stateOf(std::initializer_list<std::vector<std::byte>> parts) {
    WireBytes body;
    for (const auto& part : parts) {
        body.append(part);
    }
    return primaryPackage(16, body.bytes());
}

TEST(Primary, SubPackagesHaveTheSizesOfTheDocument) {
    EXPECT_EQ(robotMode().size(), 47U);
    EXPECT_EQ(kinematics(0).size(), 225U);
    EXPECT_EQ(configuration().size(), 445U);
}

TEST(Primary, ReadsKinematicsAndConfiguration) {
    const auto joints = primaryPackage(1, std::vector<std::byte>(246));  // skipped
    const auto package = parse(stateOf({robotMode(), joints, kinematics(0.01), configuration()}));
    ASSERT_TRUE(package) << package.error().message;
    ASSERT_TRUE(package->kinematics && package->configuration);
    EXPECT_DOUBLE_EQ(package->kinematics->theta[0], 0.01);
    EXPECT_DOUBLE_EQ(package->kinematics->a[1], -0.425);
    EXPECT_DOUBLE_EQ(package->kinematics->d[0], 0.089159);
    EXPECT_DOUBLE_EQ(package->kinematics->alpha[4], -1.5708);
    EXPECT_DOUBLE_EQ(package->configuration->lower[2], -4.3355);
    EXPECT_DOUBLE_EQ(package->configuration->upper[2], 6.3355);
    EXPECT_DOUBLE_EQ(package->configuration->max_velocity[3], 3.3416);
    EXPECT_DOUBLE_EQ(package->configuration->max_acceleration[5], 35.0);
}

TEST(Primary, ReadsTheVersion) {
    const auto package =
        parse(fromHex("00 00 00 34 14 FF FF FF FF FF FF FF FF FE 03 "
                      "09 55 52 43 6F 6E 74 72 6F 6C 05 0B "
                      "00 00 00 01 00 01 A6 2C 4A 75 6C 20 31 32 20 32 30 32 31 "
                      "2C 20 30 38"));
    ASSERT_TRUE(package) << package.error().message;
    ASSERT_TRUE(package->version);
    EXPECT_EQ(package->version->major, 5);
}

TEST(Primary, ReadsAnError) {
    const auto package = parse(
        message(6, WireBytes().i32(210).i32(1).i32(3).u32(0).u32(0).text("read\tonly ").bytes()));
    ASSERT_TRUE(package && package->report);
    EXPECT_EQ(package->report->kind, Report::Kind::error);
    EXPECT_EQ(package->report->level, Report::Level::violation);
    EXPECT_EQ(package->report->toText(), "C210A1: read only");
}

TEST(Primary, ReadsSafetyModesRuntimeExceptionsAndTexts) {
    const auto safety = parse(message(5, WireBytes().i32(4).i32(0).u8(3).u32(0).u32(0).bytes()));
    ASSERT_TRUE(safety && safety->report);
    EXPECT_EQ(safety->report->toText(), "C4A0: protective stop");
    const auto exception = parse(message(10, WireBytes().i32(3).i32(14).text("no such").bytes()));
    ASSERT_TRUE(exception && exception->report);
    EXPECT_EQ(exception->report->toText(), "runtime exception in line 3, column 14: no such");
    const auto text = parse(message(0, WireBytes().text("hello").bytes()));
    ASSERT_TRUE(text && text->report);
    EXPECT_EQ(text->report->toText(), "hello");
}

TEST(Primary, SkipsWhatItDoesNotKnow) {
    EXPECT_TRUE(parse(primaryPackage(25, fromHex("01 02"))));
    EXPECT_TRUE(parse(message(7, fromHex("01"))));
    EXPECT_TRUE(parse(stateOf({primaryPackage(99, fromHex("01"))})));
}

TEST(Primary, RefusesLengthsThatDoNotFit) {
    EXPECT_FALSE(parse(fromHex("00 00 00 05")));
    EXPECT_FALSE(parse(primaryPackage(16, fromHex("00 00 00 04 05"))));
    EXPECT_FALSE(parse(primaryPackage(16, fromHex("FF FF FF FF 05"))));
    EXPECT_FALSE(parse(primaryPackage(16, fromHex("00 00 00 09 05 00 00 00"))));
    EXPECT_FALSE(parse(stateOf({primaryPackage(5, std::vector<std::byte>(50))})));
    EXPECT_FALSE(parse(stateOf({primaryPackage(6, std::vector<std::byte>(50))})));
    EXPECT_FALSE(parse(message(6, fromHex("00 00"))));
    EXPECT_FALSE(parse(message(3, fromHex("FF 55"))));
}

TEST(Primary, RefusesKinematicsThatAreNoNumbers) {
    EXPECT_FALSE(parse(stateOf({kinematics(std::nan(""))})));
    EXPECT_FALSE(parse(stateOf({kinematics(std::numeric_limits<double>::infinity())})));
}

/// A sub-package with another number at some byte.
std::vector<std::byte> with(std::vector<std::byte> package, std::size_t at, double number) {
    const auto bytes = WireBytes().f64(number).bytes();
    std::copy(bytes.begin(), bytes.end(), package.begin() + static_cast<std::ptrdiff_t>(at));
    return package;
}

TEST(Primary, RefusesEveryNumberOfTheArmThatIsNotFinite) {
    constexpr std::size_t kHeader = 5;
    for (std::size_t i = 0; i < 24; ++i) {  // behind six checksums
        const auto broken = with(kinematics(0.0), kHeader + 24 + 8 * i, std::nan(""));
        EXPECT_FALSE(parse(stateOf({broken}))) << i;
    }
    for (std::size_t i = 0; i < 24; ++i) {
        const auto broken = with(configuration(), kHeader + 8 * i, std::nan(""));
        EXPECT_FALSE(parse(stateOf({broken}))) << i;
    }
}

TEST(Primary, TextsOfReportsNeedNoTextOfTheController) {
    EXPECT_EQ((Report{Report::Kind::error, Report::Level::fault, 210, 1, ""}).toText(), "C210A1");
    EXPECT_EQ((Report{Report::Kind::safety, Report::Level::fault, 4, 2, "x"}).toText(), "C4A2: x");
    EXPECT_EQ((Report{Report::Kind::runtime_exception, Report::Level::fault, 3, 14, ""}).toText(),
              "runtime exception in line 3, column 14");
    EXPECT_EQ((Report{Report::Kind::text, Report::Level::info, 0, 0, "hello"}).toText(), "hello");
}

TEST(Primary, ALevelThatIsNoneIsTheNearest) {
    const auto level = [](std::int32_t number) {
        const auto package = parse(
            message(6, WireBytes().i32(1).i32(0).i32(number).u32(0).u32(0).text("x").bytes()));
        return static_cast<int>(package->report->level);
    };
    EXPECT_EQ(level(-1), 0);
    EXPECT_EQ(level(2), 2);
    EXPECT_EQ(level(9), 5);
}

TEST(Primary, CutsAndCleansTexts) {
    const auto package =
        parse(message(0, WireBytes().text(std::string(1000, 'x') + "\x1b[31m").bytes()));
    ASSERT_TRUE(package && package->report);
    EXPECT_EQ(package->report->text, std::string(300, 'x'));
}

TEST(Primary, FindsTheFirstPackage) {
    StreamBuffer buffer(2 * kMaxPackageSize);
    const auto bytes = message(0, fromHex("41"));
    std::copy(bytes.begin(), bytes.end(), buffer.space().begin());
    buffer.filled(4);
    EXPECT_EQ(firstPackageSize(buffer).value(), std::nullopt);
    buffer.filled(bytes.size() - 4);
    EXPECT_EQ(firstPackageSize(buffer).value(), bytes.size());
}

class NoPrimarySize : public testing::TestWithParam<const char*> {};

TEST_P(NoPrimarySize, IsGarbage) {
    StreamBuffer buffer(64);
    const auto bytes = fromHex(GetParam());
    std::copy(bytes.begin(), bytes.end(), buffer.space().begin());
    buffer.filled(bytes.size());
    EXPECT_FALSE(firstPackageSize(buffer));
}

INSTANTIATE_TEST_SUITE_P(Sizes, NoPrimarySize,
                         testing::Values("00 00 00 04 10", "FF FF FF FF 10", "00 01 00 01 10",
                                         "80 00 00 00 10"));

}  // namespace
}  // namespace metier::ur_driver::primary
