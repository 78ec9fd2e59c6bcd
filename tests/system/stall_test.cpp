// A server whose thread hangs during a move, with a real arm's cycle and real clients: the watchdog
// stops the arm, and the skill says so once the thread is back.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <atomic>
#include <future>
#include <latch>
#include <memory>
#include <stdexcept>

#include "metier/base/wake_up_delay.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/joint_simulator/robot_options.hpp"
#include "metier/joint_simulator/simulator_drive.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua_skill/motion_device_system.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/robot_skills/arm_skills.hpp"
#include "metier/robot_skills/stall_watch.hpp"
#include "tcp_relay.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::State;
using ::testing::HasSubstr;

// Long enough for a machine that runs other tests to hang no thread by itself.
constexpr auto kLimit = 1000ms;
// The contract: from the stall to the stop.
constexpr auto kStopped = kLimit + 50ms;
// Threads on the way from the stall to the stop, each of which may wake up late.
constexpr int kLateOnTheWay = 3;

template <typename Answer>
auto orThrow(Answer answer) {
    if (!answer) {
        throw std::runtime_error(answer.error().message);
    }
    return std::move(*answer);
}

SteadyTime inAMinute() {
    return std::chrono::steady_clock::now() + 60s;
}

opcua::ServerOptions serverOptions() {
    opcua::ServerOptions options;
    options.port = 0;
    options.nodesets = {"device", "robotics", "metier"};
    return options;
}

/// A UR5 simulated in real time, and its server, which can be hung.
class HangingServer : public ::testing::Test {
protected:
    HangingServer() {
        auto arm = orThrow(robot_skills::makeArmSkills({*arm_}, model_, clock_));
        const auto system = orThrow(opcua_skill::publishMotionDeviceSystem(
            server_->nodes(),
            {"Test", "An arm of the test.", "metier", "UR5", {"1", "2", "3", "4", "5", "6"}}));
        for (auto& move : arm.moves) {
            orThrow(skills_->publish(system.skills, std::move(move), {.resource = arm.resource}));
        }
        watch_ = std::make_unique<robot_skills::StallWatch>(
            robot_skills::StallWatch::Setup{.name = "ur5",
                                            .limit = kLimit,
                                            .stop = [this] { stop(); },
                                            .log = [this](const std::string&) { ++lines_; }},
            skills_->executor(), skills_->programs(), clock_);
        if (auto started = server_->start(); !started) {
            throw std::runtime_error(started.error().message);
        }
        relay_.emplace(server_->port());
        client_ = orThrow(opcua::Client::connect(relay_->url()));
        skill_ = orThrow(client::SkillHandle::open(
            *client_, orThrow(client::findSkill(*client_, "JointPtpMoveSkill"))));
    }
    ~HangingServer() override {
        goOn();
        skill_.reset();
        client_.reset();
        watch_.reset();
    }
    HangingServer(const HangingServer&) = delete;
    HangingServer& operator=(const HangingServer&) = delete;

    void startLongMove() {
        const auto now = arm_->state().position;
        std::vector<double> target(now.begin(), now.end());
        target.front() += 2.0;
        ASSERT_TRUE(skill_->set("TargetJointPosition", target));
        ASSERT_TRUE(skill_->set("SpeedOverride", 0.2));
        ASSERT_TRUE(skill_->start());
        const auto deadline = inAMinute();
        while (arm_->state().standstill) {
            ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the arm does not move";
        }
    }

    /// \return when the thread began to hang
    SteadyTime hang() {
        std::promise<SteadyTime> hanging;
        server_->post([&] {
            hanging.set_value(std::chrono::steady_clock::now());
            hang_.wait();
        });
        return hanging.get_future().get();
    }
    void goOn() {
        if (!going_.exchange(true)) {
            hang_.count_down();
        }
    }

    void awaitStandstill() {
        const auto deadline = inAMinute();
        while (!arm_->state().standstill) {
            ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the arm still moves";
        }
    }

    const motion::RobotModel model_ =
        orThrow(motion::RobotModel::load(std::string(METIER_MODELS_DIR) + "/ur5.toml"));
    SystemClock clock_;
    std::unique_ptr<joint_simulator::JointSimulator> arm_ =
        orThrow(joint_simulator::JointSimulator::create(joint_simulator::optionsFor(model_)));
    std::unique_ptr<opcua::Server> server_ = orThrow(opcua::Server::create(serverOptions()));
    std::unique_ptr<opcua_skill::SkillServer> skills_ =
        orThrow(opcua_skill::SkillServer::create(*server_, clock_));
    joint_simulator::SimulatorDrive drive_{*arm_};
    std::unique_ptr<robot_skills::StallWatch> watch_;
    std::optional<testing::TcpRelay> relay_;  // shows what the client has sent
    std::unique_ptr<opcua::Client> client_;
    std::optional<client::SkillHandle> skill_;
    std::latch hang_{1};
    std::atomic<bool> going_ = false;
    std::promise<SteadyTime> stopped_;
    std::atomic<bool> stop_seen_ = false;
    std::atomic<int> lines_ = 0;

private:
    void stop() {
        arm_->stop();
        if (!stop_seen_.exchange(true)) {
            stopped_.set_value(std::chrono::steady_clock::now());
        }
    }
};

TEST_F(HangingServer, HasItsArmStoppedAndSaysSoOnceItIsBack) {
    startLongMove();
    const auto missed = arm_->state().missed_cycles;
    WakeUpDelay load;
    const auto hung = hang();
    auto stopped = stopped_.get_future();
    ASSERT_EQ(stopped.wait_for(60s), std::future_status::ready);
    const auto took = stopped.get() - hung;
    awaitStandstill();
    // A machine that is late with the arm's cycles is late with the stop by as much.
    const auto late = (arm_->state().missed_cycles - missed) * arm_->info().cycle +
                      kLateOnTheWay * load.takeLongest();
    EXPECT_LE(took, kStopped + late);
    fmt::print("stopped {} ms after the stall\n",
               std::chrono::round<std::chrono::milliseconds>(took).count());
    goOn();
    ASSERT_TRUE(skill_->awaitState(State::halted, inAMinute()));
    EXPECT_THAT(skill_->reasonText(), HasSubstr("ur5: the server's thread did not work for"));
    EXPECT_EQ(lines_, 1);
    ASSERT_TRUE(skill_->reset());
}

TEST_F(HangingServer, TakesAStartThatCameMeanwhileOnlyAfterwards) {
    startLongMove();
    hang();
    ASSERT_EQ(stopped_.get_future().wait_for(60s), std::future_status::ready);
    awaitStandstill();
    const auto place = arm_->state().position;
    const auto sent_before = relay_->sent().size();
    auto late = std::async(std::launch::async, [this] { return skill_->start(); });
    const auto deadline = inAMinute();
    while (relay_->sent().find("Start", sent_before) == std::string::npos) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline)
            << "Start does not come to the server";
    }
    goOn();
    EXPECT_FALSE(late.get()) << "the skill is not Ready";
    ASSERT_TRUE(skill_->awaitState(State::halted, inAMinute()));
    EXPECT_EQ(device::largestDifference(arm_->state().position, place), 0.0);
}

}  // namespace
}  // namespace metier::system_tests
