// What becomes of an arm when the process of its server dies or stops: its controller notices by
// itself.
#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <ostream>

#include "metier_program.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;

constexpr auto kNoticed = 2s;

struct ArmCase {
    const char* name;  ///< of its file in tests/system/devices
    double axis_1;     ///< of a long move [rad]
};

void PrintTo(const ArmCase& arm, std::ostream* out) {
    *out << arm.name;
}

/// A virtual controller and a server that are not children of one `metier up`, which would end the
/// one with the other.
class ArmOfAServerThatDies : public ::testing::TestWithParam<ArmCase> {
protected:
    static std::string line(process::ChildProcess& process) {
        return process.readLine(inAMinute()).value();
    }
    double position() const {
        const auto state = runMetier({"virtual", "state", address_}).output;
        return nlohmann::json::parse(state).at("joint_position").at(0).get<double>();
    }

    std::string file_ = deviceCell(GetParam().name).string();
    std::string address_ =
        "127.77." + std::to_string(getpid() / 250 % 250) + "." + std::to_string(1 + getpid() % 250);
    process::ChildProcess controller_ =
        process::ChildProcess::start(
            metierCommand({"virtual", "run", file_, "controller", "--address", address_}))
            .value();
    std::string ready_ = line(controller_);
    process::ChildProcess server_ =
        process::ChildProcess::start(metierCommand({"serve", file_, "--server", "arm", "--port",
                                                    "0", "--controller", address_}))
            .value();
    std::string url_ = line(server_).substr(std::string("ready ").size());
};

TEST_P(ArmOfAServerThatDies, StandsSoonAfter) {
    const auto client = connectTo(url_);
    auto skill = openSkill(*client, "JointPtpMoveSkill");
    auto target = jointPosition(*client, skill);
    const auto start = target.front();
    target.front() += GetParam().axis_1;
    ASSERT_TRUE(skill.set("TargetJointPosition", target));
    ASSERT_TRUE(skill.set("SpeedOverride", 0.2));
    ASSERT_TRUE(skill.start());
    const auto deadline = inAMinute();
    while (std::abs(position() - start) < 0.02) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the arm does not move";
    }
    server_.signal(SIGKILL);
    ASSERT_TRUE(server_.waitUntil(inAMinute()));
    const auto killed = std::chrono::steady_clock::now();
    auto now = position();
    for (auto last = now + 1.0; std::abs((now = position()) - last) > 1e-6; last = now) {
        ASSERT_LT(std::chrono::steady_clock::now() - killed, kNoticed) << "the arm still moves";
    }
    EXPECT_LT(std::abs(now - start), 0.95 * std::abs(GetParam().axis_1));
}

INSTANTIATE_TEST_SUITE_P(Devices, ArmOfAServerThatDies,
                         ::testing::Values(ArmCase{"ur5", 1.0}, ArmCase{"iiwa", 1.0},
                                           ArmCase{"edo", 0.6}),
                         [](const auto& arm) { return std::string(arm.param.name); });

}  // namespace
}  // namespace metier::system_tests
