// One arm, moved in turns by its own skills and by those of a move component in another process.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <stdexcept>
#include <string>

#include "arm_bench.hpp"
#include "metier_program.hpp"
#include "running_cell.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;

// Other tests hold up the machine: the best of as many turns as it takes, and of a few at least.
constexpr int kFewest = 5;
constexpr int kMost = 20;
constexpr auto kLongest = 50ms;

std::filesystem::path cellOf(const std::string& arm) {
    return std::filesystem::path(METIER_SOURCE_DIR) / "tests/system/devices" / (arm + ".toml");
}

class HandOver : public ::testing::TestWithParam<const char*> {
protected:
    /// Moves axis 1 by so much with one of the skills. \return how long after now it was refused
    std::chrono::nanoseconds move(client::SkillHandle& skill, double by) {
        auto target = home_;
        target.front() += by;
        const auto deadline = inAMinute();
        const auto asked = std::chrono::steady_clock::now();
        auto taken = asked;
        auto started = skill.startWith({.parameters = {{"TargetJointPosition", target}}});
        while (!started && started.error().code == Errc::resource_unavailable && taken < deadline) {
            started = skill.startWith({.parameters = {{"TargetJointPosition", target}}});
            taken = std::chrono::steady_clock::now();
        }
        const auto ended = skill.awaitEnd(deadline);
        if (!started || !ended || ended->to != skill::State::ready) {
            throw std::runtime_error(started ? ended ? ended->reason_text : ended.error().message
                                             : started.error().message);
        }
        return taken - asked;
    }

    RunningCell cell_{cellOf(GetParam())};
    ServerProcess component_{"ur5-move", {"--port", "0", "--robot", cell_.url("arm")}};
    std::unique_ptr<opcua::Client> owner_ = connectTo(cell_.url("arm"));
    std::unique_ptr<opcua::Client> other_ = connectTo(component_.url());
    client::SkillHandle own_ = openSkill(*owner_, "JointPtpMoveSkill");
    client::SkillHandle theirs_ = openSkill(*other_, "JointPtpMoveSkill");
    std::vector<double> home_ = jointPosition(*owner_, own_);
};

TEST_P(HandOver, TakesNoLongerThanFiftyMilliseconds) {
    auto to_own = std::chrono::nanoseconds::max();
    auto to_component = to_own;
    move(theirs_, 0.1);
    const auto met = [&] { return to_own < kLongest && to_component < kLongest; };
    for (int turn = 0; turn < kFewest || (turn < kMost && !met()); ++turn) {
        to_own = std::min(to_own, move(own_, 0.0));
        to_component = std::min(to_component, move(theirs_, 0.1));
    }
    std::cout << "refused to the arm's own skills for " << to_own / 1us
              << " us, to the component's for " << to_component / 1us << " us\n";
    EXPECT_LT(to_own, kLongest);
    EXPECT_LT(to_component, kLongest);
}

INSTANTIATE_TEST_SUITE_P(Arms, HandOver, ::testing::Values("ur5", "iiwa", "edo"),
                         [](const auto& arm) { return std::string(arm.param); });

}  // namespace
}  // namespace metier::system_tests
