// Clients of `metier serve` processes that are killed and started again, or cut off, in every
// state.
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <sched.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <future>
#include <optional>

#include "metier/base/queue.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier_program.hpp"
#include "tcp_relay.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using metier::testing::TcpRelay;
using skill::Reason;
using skill::State;
using skill::TransitionEvent;
using ::testing::HasSubstr;
using ::testing::Not;
using Delivery = opcua::Failure::Delivery;

constexpr const char* kSkill = "JointPtpMoveSkill";

/// Output of a process until its end, or until a line with certain words.
class RunningCommand {
public:
    explicit RunningCommand(const std::vector<std::string>& arguments)
        : process_(
              link::ChildProcess::start(metierCommand(arguments), link::ErrorOutput::with_output)
                  .value()) {}

    bool until(const std::string& words) {
        for (auto line = process_.readLine(inAMinute()); line;
             line = process_.readLine(inAMinute())) {
            text_ += *line + "\n";
            if (line->find(words) != std::string::npos) {
                return true;
            }
        }
        return false;
    }
    /// Its exit status.
    int end() {
        EXPECT_FALSE(until("no line has these words"));
        return process_.waitUntil(inAMinute()).value_or(-1);
    }
    void signal(int number) { process_.signal(number); }
    const std::string& text() const { return text_; }

private:
    link::ChildProcess process_;
    std::string text_;
};

/// A robot's server, a bystander who always reaches it, and a network that can be cut.
class CutOff : public ::testing::Test {
protected:
    CutOff() { watch(); }
    ~CutOff() override {
        bystanding_->onTransition({});
        std::filesystem::remove_all(folder_);
    }
    CutOff(const CutOff&) = delete;
    CutOff& operator=(const CutOff&) = delete;

    /// Looks at the server that runs now.
    void watch() {
        bystanding_.reset();
        bystander_ = connectTo(robot_->url());
        bystanding_ = openSkill(*bystander_, kSkill);
        bystanding_->onTransition([this](const TransitionEvent& event) { seen_.tryPush(event); });
        home_ = jointPosition(*bystander_, *bystanding_);
    }
    TransitionEvent next() { return seen_.popUntil(inAMinute()).value(); }

    std::vector<std::string> longRun(const std::string& on_loss = "continue") const {
        auto target = home_;
        target.front() += target.front() > 0 ? -1.0 : 1.0;
        return {"run",
                relay_.url(),
                kSkill,
                "--set",
                fmt::format("TargetJointPosition={}", fmt::join(target, ",")),
                "--set",
                "SpeedOverride=0.1",
                "--on-loss",
                on_loss};
    }
    /// `metier run` of a move of some seconds through the relay; it is Running.
    std::unique_ptr<RunningCommand> startLongRun() {
        auto run = std::make_unique<RunningCommand>(longRun());
        EXPECT_EQ(next().to, State::running);
        return run;
    }
    void cutAndComeBack(RunningCommand& client) {
        relay_.cut();
        EXPECT_TRUE(client.until("connection lost")) << client.text();
        relay_.pass();
        EXPECT_TRUE(client.until("connection back; server restarted: no")) << client.text();
    }
    void restart() {
        const auto port = robot_->port();
        bystanding_.reset();
        bystander_.reset();
        robot_->kill();
        robot_.reset();
        robot_.emplace("iiwa", std::vector<std::string>{"--port", port, "--state", folder_});
        watch();
    }
    void expectAtHome() {
        const auto position = jointPosition(*bystander_, *bystanding_);
        for (std::size_t axis = 0; axis < position.size(); ++axis) {
            EXPECT_NEAR(position[axis], home_[axis], 1e-6) << "axis " << axis + 1;
        }
    }

    const std::string folder_ = ::testing::TempDir() + fmt::format("metier_cut_off_{}", ::getpid());
    std::optional<ServerProcess> robot_{
        std::in_place, "iiwa",
        std::vector<std::string>{"--port", lastingPort(), "--state", folder_}};
    TcpRelay relay_{static_cast<std::uint16_t>(std::stoi(robot_->port()))};
    Queue<TransitionEvent> seen_{100};
    std::unique_ptr<opcua::Client> bystander_;
    std::optional<client::SkillHandle> bystanding_;
    std::vector<double> home_;
};

TEST_F(CutOff, RunningGoesOnAndItsEndIsLearnt) {
    const auto run = startLongRun();
    cutAndComeBack(*run);
    EXPECT_EQ(run->end(), 0) << run->text();
    EXPECT_EQ(next().to, State::ready);
    EXPECT_THAT(run->text(), HasSubstr("done"));
}

TEST_F(CutOff, RunningOnAServerThatIsKilledIsUnknownAtTheEndOfItsTimeout) {
    auto line = longRun();
    line.insert(line.end(), {"--timeout", "3"});
    RunningCommand run(line);
    ASSERT_EQ(next().to, State::running);
    robot_->kill();
    EXPECT_EQ(run.end(), 3) << run.text();
    EXPECT_THAT(run.text(), HasSubstr("unknown what became of the execution"));
    EXPECT_THAT(run.text(), HasSubstr("Halt did not reach it"));
}

TEST_F(CutOff, RunningEndsMeanwhileAndThatIsLearnt) {
    const auto run = startLongRun();
    relay_.cut();
    ASSERT_TRUE(run->until("connection lost"));
    EXPECT_EQ(next().to, State::ready);
    relay_.pass();
    EXPECT_EQ(run->end(), 0) << run->text();
}

TEST_F(CutOff, RunningIsOverWhenItsServerWasKilledAndStartedAgain) {
    const auto run = startLongRun();
    restart();
    EXPECT_EQ(run->end(), 4) << run->text();
    EXPECT_THAT(run->text(), HasSubstr("server restarted: yes"));
    EXPECT_THAT(run->text(), HasSubstr("not resumed, the motion is over"));
    EXPECT_EQ(*bystanding_->state(), State::ready);
    expectAtHome();  // start of the new server's arm
}

TEST_F(CutOff, RunningUnderALeaseIsHaltedAndTheRunSaysSo) {
    auto arguments = longRun("halt");
    arguments.insert(arguments.end(), {"--lease", "2s"});
    RunningCommand run(arguments);
    ASSERT_EQ(next().to, State::running);
    relay_.cut();
    const auto halted = next();
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_EQ(halted.reason, Reason::owner_lost);
    relay_.pass();
    EXPECT_EQ(run.end(), 1) << run.text();
    EXPECT_THAT(run.text(), HasSubstr("OwnerLost"));
}

TEST_F(CutOff, SuspendedStaysSuspendedAndItsEndIsLearnt) {
    const auto run = startLongRun();
    ASSERT_TRUE(bystanding_->suspend());
    ASSERT_EQ(next().to, State::suspended);
    cutAndComeBack(*run);
    EXPECT_EQ(*bystanding_->state(), State::suspended) << "nobody resumed it";
    ASSERT_TRUE(bystanding_->resume());
    EXPECT_EQ(next().to, State::running);
    EXPECT_EQ(run->end(), 0) << run->text();
}

TEST_F(CutOff, SuspendedIsOverWhenItsServerWasKilledAndStartedAgain) {
    const auto run = startLongRun();
    ASSERT_TRUE(bystanding_->suspend());
    ASSERT_EQ(next().to, State::suspended);
    restart();
    EXPECT_EQ(run->end(), 4) << run->text();
    EXPECT_EQ(*bystanding_->state(), State::ready);
}

TEST_F(CutOff, HaltedMeanwhileIsLearntWithItsReason) {
    const auto run = startLongRun();
    relay_.cut();
    ASSERT_TRUE(run->until("connection lost"));
    ASSERT_TRUE(bystanding_->halt());
    ASSERT_EQ(next().to, State::halted);
    relay_.pass();
    EXPECT_EQ(run->end(), 1) << run->text();
    EXPECT_THAT(run->text(), HasSubstr("ByClient"));
    EXPECT_EQ(*bystanding_->state(), State::halted) << "nobody reset it";
}

/// A client in this process, in Ready and Halted, where nothing runs that could be waited for.
class CutOffClient : public CutOff {
protected:
    using Change = opcua::ConnectionChange::Kind;

    CutOffClient() {
        opcua::ClientOptions options;
        options.reconnect.emplace();
        client_ = opcua::Client::connect(relay_.url(), options).value();
        client_->onConnectionChange([this](const auto& change) { changes_.tryPush(change); });
        skill_ = openSkill(*client_, kSkill);
    }
    opcua::ConnectionChange nextIs(Change kind) {
        auto change = changes_.popUntil(inAMinute()).value();
        EXPECT_EQ(change.kind, kind) << change.why.message;
        return change;
    }
    void cutAndComeBack() {
        relay_.cut();
        nextIs(Change::lost);
        relay_.pass();
        EXPECT_FALSE(nextIs(Change::back).server_restarted);
    }
    void restartAndComeBack() {
        restart();
        nextIs(Change::lost);
        EXPECT_TRUE(nextIs(Change::back).server_restarted);
    }

    Queue<opcua::ConnectionChange> changes_{100};
    std::unique_ptr<opcua::Client> client_;
    std::optional<client::SkillHandle> skill_;
};

TEST_F(CutOffClient, ReadyIsGoodForARunAfterACutAndAfterARestart) {
    const skill::ValueMap target{{"TargetJointPosition", home_}};
    cutAndComeBack();
    ASSERT_TRUE(skill_->run(target, inAMinute()));
    restartAndComeBack();
    const auto moved = skill_->runWith({.parameters = target}, inAMinute());
    EXPECT_TRUE(moved) << moved.error().message;
}

TEST_F(CutOffClient, HaltedStaysHaltedOverACutAndIsReadyAfterARestart) {
    ASSERT_TRUE(skill_->halt());
    cutAndComeBack();
    EXPECT_EQ(*skill_->state(), State::halted);
    restartAndComeBack();
    EXPECT_EQ(*skill_->state(), State::ready);
}

TEST_F(CutOff, AStartThatDoesNotArriveMovesNothing) {
    relay_.cutAt("TargetJointPosition", TcpRelay::Moment::before);
    RunningCommand run(longRun());
    ASSERT_TRUE(relay_.awaitCut(inAMinute()));
    relay_.pass();
    EXPECT_EQ(run.end(), 1) << run.text();
    EXPECT_THAT(run.text(), HasSubstr("nothing was started"));
    EXPECT_EQ(*bystanding_->state(), State::ready);
    EXPECT_FALSE(seen_.popUntil(SteadyTime{}));
    expectAtHome();
}

TEST_F(CutOff, AStartWhoseAnswerIsLostHappensOnce) {
    relay_.cutAt("TargetJointPosition", TcpRelay::Moment::after);
    RunningCommand run(longRun());
    ASSERT_TRUE(relay_.awaitCut(inAMinute()));
    EXPECT_EQ(next().to, State::running);
    relay_.pass();
    EXPECT_EQ(run.end(), 0) << run.text();
    EXPECT_EQ(next().to, State::ready);
    EXPECT_FALSE(seen_.popUntil(SteadyTime{})) << "it happened again";
}

TEST_F(CutOff, ARunThatIsInterruptedByItsUserDoesNotWaitForTheConnection) {
    const auto run = startLongRun();
    relay_.cut();
    ASSERT_TRUE(run->until("connection lost"));
    run->signal(SIGINT);
    EXPECT_EQ(run->end(), 3) << run->text();
    EXPECT_THAT(run->text(), HasSubstr("unknown what became of"));
}

TEST_F(CutOff, WatchTellsOfLossAndReturnAndGoesOn) {
    RunningCommand watch({"watch", relay_.url(), kSkill});
    ASSERT_TRUE(watch.until("watching"));
    cutAndComeBack(watch);
    ASSERT_TRUE(bystanding_->halt());
    EXPECT_TRUE(watch.until("Halted")) << watch.text();
    restart();
    EXPECT_TRUE(watch.until("connection back; server restarted: yes")) << watch.text();
    ASSERT_TRUE(bystanding_->halt());
    EXPECT_TRUE(watch.until("Halted")) << watch.text();
    watch.signal(SIGTERM);
    EXPECT_EQ(watch.end(), 0);
}

TEST_F(CutOff, WatchTellsInJsonWhatHappenedMeanwhile) {
    RunningCommand watch({"watch", relay_.url(), kSkill, "--json", "--count", "1"});
    ASSERT_TRUE(watch.until("watching"));
    relay_.cut();
    ASSERT_TRUE(watch.until(R"("connection":"lost")")) << watch.text();
    ASSERT_TRUE(bystanding_->halt());
    ASSERT_TRUE(bystanding_->awaitState(State::halted, inAMinute()));
    relay_.pass();
    EXPECT_EQ(watch.end(), 0) << watch.text();
    EXPECT_THAT(watch.text(), HasSubstr(R"("to":"Halted")"));
}

TEST_F(CutOff, OwnSaysThatControlIsLostWithItsConnection) {
    RunningCommand own({"own", relay_.url(), "--lease", "10s"});
    ASSERT_TRUE(own.until("Ctrl-C gives it back")) << own.text();
    relay_.cut();
    EXPECT_EQ(own.end(), 1);
    EXPECT_THAT(own.text(), HasSubstr("is lost"));
    EXPECT_THAT(own.text(), HasSubstr("not taken again"));
}

TEST_F(CutOff, OwnSaysThatControlIsLostWithItsServer) {
    RunningCommand own({"own", relay_.url(), "--lease", "10s"});
    ASSERT_TRUE(own.until("Ctrl-C gives it back")) << own.text();
    restart();
    EXPECT_EQ(own.end(), 1);
    EXPECT_THAT(own.text(), HasSubstr("not taken again"));
    EXPECT_TRUE(bystanding_->runWith({.parameters = {{"TargetJointPosition", home_}}}, inAMinute()))
        << "nobody has control of the new server";
}

TEST_F(CutOff, ResumeSaysThatTheMotionIsOverWhenTheServerWasStartedAgain) {
    const auto run = startLongRun();
    ASSERT_TRUE(bystanding_->suspend());
    ASSERT_EQ(next().to, State::suspended);
    RunningCommand resume({"resume", relay_.url(), kSkill});
    ASSERT_TRUE(resume.until("Running"));
    restart();
    EXPECT_EQ(resume.end(), 4) << resume.text();
}

/// A robot's server in a network of its own, whose only link can be taken down: nothing is
/// answered, nothing is refused, and what was sent waits in the kernel, as behind a pulled cable.
class PulledCable : public ::testing::Test {
protected:
    void SetUp() override {
        if (::geteuid() != 0) {
            GTEST_SKIP() << "NOT TESTED: a network of its own needs root";
        }
        std::vector<std::string> command{
            "unshare", "-n", "sh", "-c", "ip link set lo up && exec \"$@\"", "sh"};
        const auto serve =
            metierCommand({"serve", simulatedCell().string(), "--server", "iiwa", "--port", "0"});
        command.insert(command.end(), serve.begin(), serve.end());
        server_.emplace(link::ChildProcess::start(command).value());
        const auto ready = server_->readLine(inAMinute());
        if (!ready) {
            GTEST_SKIP() << "NOT TESTED: no network of its own: " << ready.error().message;
        }
        url_ = ready->substr(std::string("ready ").size());
    }
    void link(const std::string& state) {
        const auto target = std::to_string(server_->pid());
        auto ip = link::ChildProcess::start(
                      {"nsenter", "-t", target, "-n", "ip", "link", "set", "lo", state})
                      .value();
        ASSERT_EQ(ip.waitUntil(inAMinute()), 0);
    }
    /// Runs `work` in a thread of the server's network; threads that it starts are there, too.
    template <typename Work>
    auto inside(Work work) {
        const auto path = fmt::format("/proc/{}/ns/net", server_->pid());
        return std::async(std::launch::async, [path, work] {
            const int space = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
            const bool entered = space >= 0 && ::setns(space, CLONE_NEWNET) == 0;
            EXPECT_TRUE(entered);
            ::close(space);
            return work();
        });
    }

    std::optional<link::ChildProcess> server_;
    std::string url_;
};

TEST_F(PulledCable, LosesAStartWithoutEverStartingItLater) {
    opcua::ClientOptions options;
    options.session_timeout = 20s;
    options.call_timeout = 2s;
    options.reconnect.emplace();
    Queue<opcua::ConnectionChange> changes(10);
    auto client = inside([&] { return opcua::Client::connect(url_, options); }).get().value();
    client->onConnectionChange([&](const auto& change) { changes.tryPush(change); });
    auto skill = openSkill(*client, kSkill);
    const auto home = jointPosition(*client, skill);
    auto target = home;
    target.front() += 0.1;
    link("down");
    const auto started = skill.startWith(
        {.execution_id = "order 66", .parameters = {{"TargetJointPosition", target}}});
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().delivery, Delivery::unknown) << started.error().message;
    EXPECT_EQ(changes.popUntil(inAMinute())->kind, opcua::ConnectionChange::Kind::lost);
    link("up");
    const auto back = changes.popUntil(inAMinute()).value();
    EXPECT_EQ(back.kind, opcua::ConnectionChange::Kind::back);
    EXPECT_TRUE(back.same_session);
    EXPECT_EQ(skill.execution("order 66").error().code, Errc::not_found);
    EXPECT_EQ(*skill.state(), State::ready);
    EXPECT_EQ(jointPosition(*client, skill), home);
    const auto again = skill.runWith(
        {.execution_id = "order 66", .parameters = {{"TargetJointPosition", target}}}, inAMinute());
    EXPECT_TRUE(again) << again.error().message;
    client.reset();
}

}  // namespace
}  // namespace metier::system_tests
