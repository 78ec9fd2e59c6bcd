#include "served_arm.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <future>

#include "metier/client/testing/arm_data.hpp"
#include "metier/joint_simulator/robot_options.hpp"
#include "metier/opcua_skill/live_figures.hpp"
#include "metier/opcua_skill/motion_device_system.hpp"
#include "metier/robot_skills/arm_skills.hpp"

namespace metier::client {
namespace {

using namespace std::chrono_literals;

motion::RobotModel loadModel() {
    return motion::RobotModel::load(std::filesystem::path(METIER_MODELS) / "ur5.toml").value();
}

/// With the reserve of a drive: a stream whose set-points are late is braked with it.
joint_simulator::JointSimulatorOptions simulatorOptions(const motion::RobotModel& model) {
    auto options = joint_simulator::optionsFor(model);
    options.name = "ur5";
    options.cycle = 8ms;
    return options;
}

opcua_skill::KinematicsData dataOf(const motion::RobotModel& model, double fastest) {
    auto data = testing::dataOf(model);
    for (auto& velocity : data.max_joint_velocity) {
        velocity *= fastest;
    }
    return data;
}

opcua_skill::KinematicsState stateOf(const device::Arm& arm) {
    const auto state = arm.state();
    opcua_skill::KinematicsState result;
    result.joint_position.assign(state.position.begin(), state.position.end());
    result.safety_state = state.safety == device::SafetyState::normal
                              ? opcua_skill::SafetyStateKind::normal
                              : opcua_skill::SafetyStateKind::protective_stop;
    result.missed_cycles = state.missed_cycles;
    return result;
}

}  // namespace

ServedArm::ServedArm(std::uint16_t port, double fastest) : model_(loadModel()) {
    arm_ = joint_simulator::JointSimulator::create(simulatorOptions(model_)).value();
    opcua::ServerOptions options;
    options.port = port;
    options.nodesets = {"device", "robotics", "metier", "universal_robots"};
    server_ = opcua::Server::create(options).value();
    skills_ = opcua_skill::SkillServer::create(*server_, clock_).value();
    const auto system = opcua_skill::findMotionDeviceSystem(server_->nodes()).value();
    // The machine may hold a thread up for long.
    auto skills = robot_skills::makeArmSkills({*arm_}, model_, clock_,
                                              {.longest_silence = 1.5, .largest_lag = 1.5})
                      .value();
    const auto node = server_->nodes().browse(system.skills).value().front().target;
    program_ = skills_->bind(node, std::move(skills.position_stream)).value();
    program_->attach(*this);
    const auto published = opcua_skill::publishKinematics(
        server_->nodes(), system, dataOf(model_, fastest), [this] { return stateOf(*arm_); });
    EXPECT_TRUE(published);
    EXPECT_TRUE(opcua_skill::publishArmFigures(
        server_->nodes(), system.kinematics,
        {.standstill = [this] { return std::optional(arm_->state().standstill); }}));
    drive_ = std::make_unique<joint_simulator::SimulatorDrive>(*arm_);
    const auto started = server_->start();
    EXPECT_TRUE(started) << (started ? "" : started.error().message);
}

ServedArm::~ServedArm() {
    watch_.reset();
    skills_.reset();
}

void ServedArm::watchDevice() {
    watch_.emplace(*arm_, skills_->executor(), std::vector<skill::Program*>{program_});
}

std::shared_ptr<void> ServedArm::keepBusy() {
    // Shared by the server's thread, which waits for its end.
    const auto ends = std::make_shared<std::promise<void>>();
    const auto begun = std::make_shared<std::promise<void>>();
    server_->post([begun, ended = std::make_shared<std::future<void>>(ends->get_future())] {
        begun->set_value();
        ended->wait_for(30s);
    });
    begun->get_future().wait();
    return {nullptr, [ends](void*) { ends->set_value(); }};
}

void ServedArm::onTransition(const skill::TransitionEvent& event) {
    {
        const std::lock_guard lock(mutex_);
        running_ = event.to == skill::State::running;
    }
    changed_.notify_all();
}

bool ServedArm::awaitRunning(bool wanted) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 30s, [&] { return running_ == wanted; });
}

}  // namespace metier::client
