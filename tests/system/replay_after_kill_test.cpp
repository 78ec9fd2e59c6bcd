// A server process is killed and started again: what was sent to it before moves nothing after.
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>

#include "metier/client/control_handle.hpp"
#include "metier_program.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::State;
using ::testing::HasSubstr;

class KilledServer : public ::testing::Test {
protected:
    KilledServer() { std::filesystem::remove_all(folder_); }
    ~KilledServer() override { std::filesystem::remove_all(folder_); }
    KilledServer(const KilledServer&) = delete;
    KilledServer& operator=(const KilledServer&) = delete;

    ServerProcess start() const {
        return ServerProcess("iiwa", {"--port", "0", "--state", folder_.string()});
    }
    /// A move of the last axis, of a tenth of a second.
    static skill::StartRequest moveOf(std::vector<double> joints, const std::string& name) {
        joints.back() += 0.02;
        return {.execution_id = name, .parameters = {{"TargetJointPosition", joints}}};
    }
    /// The arm stays where it is, whatever was refused.
    static void expectStill(opcua::Client& client, client::SkillHandle& skill,
                            const std::vector<double>& joints) {
        EXPECT_EQ(*skill.state(), State::ready);
        EXPECT_EQ(jointPosition(client, skill), joints);
    }

    const std::filesystem::path folder_ =
        std::filesystem::path(::testing::TempDir()) / "metier_killed_server";
};

TEST_F(KilledServer, TakesNoCommandOfItsLifeBefore) {
    constexpr int lives = 3;
    skill::StartRequest before;
    for (int life = 0; life < lives; ++life) {
        auto server = start();
        const auto client = connectTo(server.url());
        auto skill = openSkill(*client, "JointPtpMoveSkill");
        const auto home = jointPosition(*client, skill);
        if (life > 0) {
            const auto stale = skill.startWith(before);
            ASSERT_FALSE(stale);
            EXPECT_EQ(stale.error().code, Errc::already_exists) << stale.error().message;
            EXPECT_THAT(skill.execution(before.execution_id).error().message,
                        HasSubstr("has begun once"));
            auto named_anew = before;
            named_anew.execution_id += " again";
            EXPECT_EQ(skill.startWith(named_anew).error().code, Errc::locked) << "its epoch";
            named_anew.epoch = 0;
            named_anew.deadline = std::chrono::system_clock::now() - 1ms;
            EXPECT_EQ(skill.startWith(named_anew).error().code, Errc::timeout);
            EXPECT_EQ(skill.start().error().code, Errc::invalid_argument) << "nothing is written";
            expectStill(*client, skill, home);
        }
        const auto control = client::ControlHandle::acquire(
            *client, skill.address().controller()->node, {.lease = 30s});
        ASSERT_TRUE(control) << control.error().message;
        before = moveOf(home, "move " + std::to_string(life));
        before.epoch = control->epoch();
        const auto moved = skill.runWith(before, inAMinute());
        ASSERT_TRUE(moved) << moved.error().message;
        server.kill();
    }
}

}  // namespace
}  // namespace metier::system_tests
