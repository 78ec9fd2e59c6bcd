#include "primary_packages.hpp"

#include <gmock/gmock.h>

#include <map>

#include "robot_fixture.hpp"

namespace metier::virtual_ur {
namespace {

using testing::ElementsAre;
using testing::Key;

/// A decoder of its own, as far as these tests look: plain loads at the maker's offsets.
class Decoder {
public:
    explicit Decoder(Bytes bytes) : bytes_(std::move(bytes)) {}

    std::uint64_t unsignedAt(std::size_t offset, std::size_t size) const {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < size; ++i) {
            value = value * 256 + std::to_integer<std::uint64_t>(bytes_.at(offset + i));
        }
        return value;
    }
    int byteAt(std::size_t offset) const { return static_cast<int>(unsignedAt(offset, 1)); }
    double doubleAt(std::size_t offset) const {
        const auto bits = unsignedAt(offset, 8);
        double value = 0;
        static_assert(sizeof(value) == sizeof(bits));
        std::memcpy(&value, &bits, sizeof(value));
        return value;
    }
    std::string textAt(std::size_t offset, std::size_t size) const {
        std::string text;
        for (std::size_t i = 0; i < size; ++i) {
            text += static_cast<char>(byteAt(offset + i));
        }
        return text;
    }
    std::size_t size() const { return bytes_.size(); }
    Decoder part(std::size_t offset, std::size_t size) const {
        return Decoder(Bytes(bytes_.begin() + static_cast<std::ptrdiff_t>(offset),
                             bytes_.begin() + static_cast<std::ptrdiff_t>(offset + size)));
    }

private:
    Bytes bytes_;
};

/// The parts of a robot state package, by type.
std::map<int, Decoder> partsOf(const Decoder& package) {
    std::map<int, Decoder> parts;
    EXPECT_EQ(package.unsignedAt(0, 4), package.size());
    EXPECT_EQ(package.byteAt(4), 16);
    for (std::size_t at = 5; at < package.size();) {
        const auto size = package.unsignedAt(at, 4);
        parts.emplace(package.byteAt(at + 4), package.part(at, size));
        at += size;
    }
    return parts;
}

class PrimaryPackages : public testing::TestWithParam<std::string> {
protected:
    Decoder package() const {
        return Decoder(robotStatePackage(table_.robot.state(), table_.robot.options().description));
    }
    RobotOnTable table_{GetParam()};
};

TEST_P(PrimaryPackages, PartsHaveTheSizesOfTheMaker) {
    const std::map<int, std::size_t> sizes{{0, 47},  {1, 251}, {2, 37}, {3, 75}, {4, 101},
                                           {5, 225}, {6, 445}, {7, 61}, {8, 9},  {9, 53},
                                           {10, 43}, {11, 26}, {12, 12}};
    const auto parts = partsOf(package());
    EXPECT_EQ(parts.size(), GetParam() == "ur5" ? 11U : 13U);
    for (const auto& [type, part] : parts) {
        EXPECT_EQ(part.size(), sizes.at(type)) << "part " << type;
    }
}

TEST_P(PrimaryPackages, TheRobotModeIsToldWithItsFlags) {
    const auto running = partsOf(package()).at(0);
    EXPECT_EQ(running.unsignedAt(5, 8), 64'000'000U);  // microseconds
    EXPECT_EQ(running.byteAt(15), 1);                  // power is on
    EXPECT_EQ(running.byteAt(16), 0);                  // no emergency stop
    EXPECT_EQ(running.byteAt(17), 0);                  // no protective stop
    EXPECT_EQ(running.byteAt(18), 0);                  // no program
    EXPECT_EQ(running.byteAt(20), 7);
    EXPECT_EQ(running.doubleAt(22), 1.0);
    EXPECT_EQ(running.doubleAt(30), 1.0);
    table_.robot.takeScript("def p():\n  while True:\n    sync()\n  end\nend\n");
    table_.cycles(1);
    EXPECT_EQ(partsOf(package()).at(0).byteAt(18), 1);
    table_.robot.protectiveStop({157, "collision"});
    table_.cycles(2);
    const auto stopped = partsOf(package()).at(0);
    EXPECT_EQ(stopped.byteAt(17), 1);
    EXPECT_EQ(stopped.byteAt(18), 0);
    EXPECT_EQ(stopped.byteAt(19), 1);  // paused
}

TEST_P(PrimaryPackages, JointsAndToolAreWhereTheRobotIs) {
    const auto parts = partsOf(package());
    const auto& state = table_.robot.state();
    for (std::size_t i = 0; i < kAxes; ++i) {
        EXPECT_EQ(parts.at(1).doubleAt(5 + 41 * i), state.actual_q[i]);
        EXPECT_EQ(parts.at(1).doubleAt(5 + 41 * i + 8), state.target_q[i]);
        EXPECT_EQ(parts.at(1).byteAt(5 + 41 * i + 40), 253);
        EXPECT_EQ(parts.at(4).doubleAt(5 + 8 * i), state.actual_tcp_pose[i]);
    }
    EXPECT_EQ(parts.at(3).byteAt(5 + 60), 1);  // safety mode normal
}

TEST_P(PrimaryPackages, ConfigurationHasLimitsAndKinematics) {
    const auto parts = partsOf(package());
    const auto& configuration = parts.at(6);
    EXPECT_NEAR(configuration.doubleAt(5), -2 * M_PI, 1e-9);
    EXPECT_NEAR(configuration.doubleAt(5 + 96), M_PI, 1e-9);     // 180 deg/s
    EXPECT_NEAR(configuration.doubleAt(5 + 104), 40.0, 1e-9);    // rad/s2
    EXPECT_NEAR(configuration.doubleAt(5 + 192), 1.0472, 1e-4);  // default joint speed
    const std::size_t a = 5 + 192 + 40;
    const std::size_t d = a + 48;
    const std::size_t alpha = d + 48;
    EXPECT_NEAR(configuration.doubleAt(a + 8), -0.425, 1e-12);
    EXPECT_NEAR(configuration.doubleAt(d), GetParam() == "ur5" ? 0.089159 : 0.1625, 1e-12);
    EXPECT_NEAR(configuration.doubleAt(d + 40), GetParam() == "ur5" ? 0.0823 : 0.0996, 1e-12);
    EXPECT_NEAR(configuration.doubleAt(alpha), M_PI / 2.0, 1e-12);
    EXPECT_NEAR(configuration.doubleAt(alpha + 32), -M_PI / 2.0, 1e-12);
    EXPECT_EQ(configuration.unsignedAt(5 + 192 + 40 + 192 + 8, 4), 1U);  // a UR5
    // Kinematics: sums, then theta, a, d, alpha.
    const auto& kinematics = parts.at(5);
    EXPECT_NEAR(kinematics.doubleAt(5 + 24 + 48 + 8), -0.425, 1e-12);
    EXPECT_NEAR(kinematics.doubleAt(5 + 24 + 144), M_PI / 2.0, 1e-12);
}

TEST_P(PrimaryPackages, TheVersionMessageIsTheMakers) {
    const auto& description = table_.robot.options().description;
    const Decoder message(versionMessage(description));
    EXPECT_EQ(message.unsignedAt(0, 4), message.size());
    EXPECT_EQ(message.size(), 35 + description.build_date.size());
    EXPECT_EQ(message.byteAt(4), 20);
    EXPECT_EQ(message.unsignedAt(5, 8), ~std::uint64_t{0});
    EXPECT_EQ(message.byteAt(13), 0xFE);
    EXPECT_EQ(message.byteAt(14), 3);
    EXPECT_EQ(message.byteAt(15), 9);
    EXPECT_EQ(message.textAt(16, 9), "URControl");
    EXPECT_EQ(message.byteAt(25), GetParam() == "ur5" ? 3 : 5);
    EXPECT_EQ(message.byteAt(26), GetParam() == "ur5" ? 15 : 12);
}

TEST_P(PrimaryPackages, TheRealTimePackageHasTheSizeAndPlacesOfTheVersion) {
    table_.robot.takeScript("sec p():\n  set_payload(1.5, [0.1, 0.2, 0.3])\nend\n");
    table_.cycles(2);
    const bool cb3 = GetParam() == "ur5";
    const auto& state = table_.robot.state();
    const Decoder package(realtimePackage(state, cb3 ? Series::cb3 : Series::e_series));
    EXPECT_EQ(package.size(), cb3 ? 1116U : 1220U);
    EXPECT_EQ(package.unsignedAt(0, 4), package.size());
    // The maker numbers the doubles from 1.
    const auto column = [&](std::size_t number) { return package.doubleAt(4 + 8 * (number - 1)); };
    EXPECT_EQ(column(1), state.timestamp);
    EXPECT_EQ(column(3), state.target_q[1]);
    EXPECT_EQ(column(33), state.actual_q[1]);
    EXPECT_EQ(column(56), state.actual_tcp_pose[0]);
    EXPECT_EQ(column(74), state.target_tcp_pose[0]);
    EXPECT_EQ(column(95), 7);     // robot mode
    EXPECT_EQ(column(96), 253);   // joint mode
    EXPECT_EQ(column(102), 1);    // safety mode
    EXPECT_EQ(column(118), 1.0);  // speed scaling
    EXPECT_EQ(column(122), 48);   // main voltage
    EXPECT_EQ(column(132), 1);    // program stopped
    EXPECT_EQ(column(133), state.elbow_position[0]);
    EXPECT_EQ(column(139), 1);  // safety status
    if (!cb3) {
        EXPECT_EQ(column(143), 1.5);
        EXPECT_EQ(column(146), 0.3);
    }
}

INSTANTIATE_TEST_SUITE_P(Series, PrimaryPackages, testing::Values("ur5", "ur5e"));

TEST(PrimaryMessages, AreLaidOutAsTheMakers) {
    const Decoder key(keyMessage(0x03DF7E0D50, "PROGRAM_XXX_STARTED", "silly"));
    EXPECT_EQ(key.size(), 48U);  // as seen in a captured stream
    EXPECT_EQ(key.byteAt(13), 0xFD);
    EXPECT_EQ(key.byteAt(14), 7);
    EXPECT_EQ(key.byteAt(23), 19);
    EXPECT_EQ(key.textAt(24, 24), "PROGRAM_XXX_STARTEDsilly");

    const Decoder exception(
        runtimeExceptionMessage(64'008'000, 2, 1, "syntax_error_on_line:2:end:"));
    EXPECT_EQ(exception.size(), 50U);  // as seen
    EXPECT_EQ(exception.unsignedAt(5, 8), 64'008'000U);
    EXPECT_EQ(exception.byteAt(14), 10);
    EXPECT_EQ(exception.unsignedAt(15, 4), 2U);
    EXPECT_EQ(exception.unsignedAt(19, 4), 1U);

    const Decoder error(errorCodeMessage(1, {210, 3, ErrorCode::Level::violation, "text"}));
    EXPECT_EQ(error.unsignedAt(15, 4), 210U);
    EXPECT_EQ(error.unsignedAt(19, 4), 3U);
    EXPECT_EQ(error.unsignedAt(23, 4), 3U);
    EXPECT_EQ(error.textAt(35, 4), "text");

    const Decoder safety(safetyModeMessage(1, SafetyMode::protective_stop));
    EXPECT_EQ(safety.byteAt(14), 5);
    EXPECT_EQ(safety.byteAt(23), 3);
    EXPECT_EQ(safety.size(), 32U);

    EXPECT_EQ(Decoder(textMessage(1, "log")).textAt(15, 3), "log");
}

}  // namespace
}  // namespace metier::virtual_ur
