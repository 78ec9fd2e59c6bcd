// Control, and the behaviour of the arm when the process that has it dies or stops.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include <csignal>

#include "metier/base/queue.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier_program.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;
using skill::TransitionEvent;
using ::testing::HasSubstr;

/// One robot's server, watched by a client that does not command.
class OwnedRobot : public ::testing::Test {
protected:
    OwnedRobot() {
        skill_.onTransition([this](const TransitionEvent& event) {
            transitions_.tryPush({event, std::chrono::steady_clock::now()});
        });
        home_ = jointPosition(*watcher_, skill_);
    }
    ~OwnedRobot() override { skill_.onTransition({}); }
    OwnedRobot(const OwnedRobot&) = delete;
    OwnedRobot& operator=(const OwnedRobot&) = delete;

    struct Seen {
        TransitionEvent event;
        SteadyTime when;
    };
    Seen next() { return transitions_.popUntil(inAMinute()).value(); }

    /// `metier run` of a move of axis 1 that takes some seconds; it is Running.
    link::ChildProcess startLongRun(const std::vector<std::string>& owner) {
        auto target = home_;
        target.front() += 1.0;
        std::vector<std::string> arguments{
            "run",
            robot_.url(),
            skill_.address().name,
            "--set",
            fmt::format("TargetJointPosition={}", fmt::join(target, ",")),
            "--set",
            "SpeedOverride=0.1"};
        arguments.insert(arguments.end(), owner.begin(), owner.end());
        auto run = link::ChildProcess::start(metierCommand(arguments)).value();
        EXPECT_EQ(next().event.to, State::running);
        return run;
    }

    ServerProcess robot_{"iiwa"};
    Queue<Seen> transitions_{100};
    std::unique_ptr<opcua::Client> watcher_ = connectTo(robot_.url());
    client::SkillHandle skill_ = openSkill(*watcher_, "JointPtpMoveSkill");
    std::vector<double> home_;
};

TEST_F(OwnedRobot, HaltsWhenTheProcessThatCommandsItIsKilledOrStopped) {
    for (const int signal : {SIGKILL, SIGSTOP}) {
        auto run = startLongRun({"--lease", "2s"});
        const auto before = std::chrono::steady_clock::now();
        run.signal(signal);
        const auto halted = next();
        EXPECT_EQ(halted.event.to, State::halted);
        EXPECT_EQ(halted.event.reason, Reason::owner_lost) << halted.event.reason_text;
        EXPECT_THAT(halted.event.reason_text, HasSubstr("no heartbeat"));
        EXPECT_LT(halted.when - before, 10s) << "the lease counts, not the 30 s of the session";
        const auto resting = jointPosition(*watcher_, skill_);
        EXPECT_LT(resting.front(), home_.front() + 1.0);
        for (std::size_t axis = 1; axis < resting.size(); ++axis) {
            EXPECT_NEAR(resting[axis], home_[axis], 1e-3) << "axis " << axis + 1;
        }
        run.signal(SIGKILL);
        ASSERT_EQ(runMetier({"reset", robot_.url(), skill_.address().name}).status, 0);
        EXPECT_EQ(next().event.to, State::ready);
        ASSERT_TRUE(skill_.run({{"TargetJointPosition", home_}}, inAMinute()));
        EXPECT_EQ(next().event.to, State::running);
        EXPECT_EQ(next().event.to, State::ready);
    }
}

TEST_F(OwnedRobot, IsSuspendedIfItsStartSaysSoAndAnotherClientGoesOn) {
    auto run = startLongRun({"--lease", "2s", "--on-loss", "suspend"});
    run.signal(SIGKILL);
    const auto suspended = next();
    EXPECT_EQ(suspended.event.to, State::suspended);
    EXPECT_EQ(suspended.event.reason, Reason::owner_lost);
    ASSERT_EQ(runMetier({"resume", robot_.url(), skill_.address().name}).status, 0);
    EXPECT_EQ(next().event.to, State::running);
    EXPECT_EQ(next().event.to, State::ready);
    EXPECT_NEAR(jointPosition(*watcher_, skill_).front(), home_.front() + 1.0, 1e-3);
}

TEST_F(OwnedRobot, IsLeftAloneByTheCommandLineOfOthers) {
    auto own =
        link::ChildProcess::start(metierCommand({"own", robot_.url(), "--lease", "30s"})).value();
    EXPECT_THAT(own.readLine(inAMinute()).value(), HasSubstr("taken, epoch"));
    const auto refused = skill_.set("TargetJointPosition", home_);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::locked);
    EXPECT_THAT(refused.error().message, HasSubstr("has control"));
    const auto second = runMetier({"own", robot_.url()});
    EXPECT_EQ(second.status, 1);
    EXPECT_THAT(second.output, HasSubstr("has control"));
    EXPECT_TRUE(skill_.halt()) << "Halt is everybody's";
    EXPECT_EQ(next().event.to, State::halted);
    own.signal(SIGTERM);
    EXPECT_EQ(own.waitUntil(inAMinute()), 0);
    EXPECT_TRUE(skill_.reset());
}

TEST_F(OwnedRobot, IsSuspendedAndResumedFromTheCommandLine) {
    auto run = startLongRun({});
    const auto name = skill_.address().name;
    const auto suspended = runMetier({"suspend", robot_.url(), name});
    EXPECT_EQ(suspended.status, 0) << suspended.output;
    EXPECT_THAT(suspended.output, HasSubstr("Suspended"));
    EXPECT_EQ(next().event.to, State::suspended);
    EXPECT_EQ(runMetier({"suspend", robot_.url(), name}).status, 1);
    EXPECT_EQ(runMetier({"resume", robot_.url(), name}).status, 0);
    EXPECT_EQ(next().event.to, State::running);
    EXPECT_EQ(run.waitUntil(inAMinute()), 0);
    EXPECT_EQ(next().event.to, State::ready);
}

TEST_F(OwnedRobot, ChecksAMoveAsItsStartWould) {
    const auto fine = skill_.check({{"TargetJointPosition", home_}});
    ASSERT_TRUE(fine) << fine.error().message;
    EXPECT_TRUE(fine->possible) << fine->reason;
    auto target = home_;
    target.front() += 1.0;
    const auto move = skill_.check({{"TargetJointPosition", target}}).value();
    EXPECT_TRUE(move.possible);
    EXPECT_GT(move.planned_duration, 0.1);
    ASSERT_GE(move.joint_path.size(), 2U);
    EXPECT_NEAR(move.joint_path.front().front(), home_.front(), 1e-6);
    EXPECT_NEAR(move.joint_path.back().front(), target.front(), 1e-6);
    auto cartesian = openSkill(*watcher_, "CartesianLinearMoveSkill");
    const skill::ValueMap far{{"TargetPosition", skill::Frame{3.0, 0, 0, 0, 0, 0}}};
    const auto refusal = cartesian.check(far).value();
    EXPECT_FALSE(refusal.possible);
    const auto started = cartesian.startWith({.parameters = far});
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().message, HasSubstr(refusal.reason));
}

}  // namespace
}  // namespace metier::system_tests
