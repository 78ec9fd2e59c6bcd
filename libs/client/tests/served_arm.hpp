#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/joint_simulator/joint_simulator.hpp"
#include "metier/joint_simulator/simulator_drive.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/robot_skills/device_watch.hpp"
#include "metier/skill/program_observer.hpp"

namespace metier::client {

/// A simulated UR5 behind a server that offers its PositionStreamSkill.
class ServedArm : private skill::ProgramObserver {
public:
    /// \param port 0: a free one
    /// \param fastest factor on the largest joint velocities that it publishes
    explicit ServedArm(std::uint16_t port = 0, double fastest = 1.0);
    ~ServedArm() override;
    ServedArm(const ServedArm&) = delete;
    ServedArm& operator=(const ServedArm&) = delete;

    std::string url() const { return server_->endpointUrl(); }
    std::uint16_t port() const { return server_->port(); }
    joint_simulator::JointSimulator& arm() { return *arm_; }

    /// The skill is halted when the arm is stopped, also while it does not run.
    void watchDevice();

    /// Waits until the stream runs, or has ended; false after 30 s.
    bool awaitStreamStart() { return awaitRunning(true); }
    bool awaitStreamEnd() { return awaitRunning(false); }

    /// Blocks the server's thread until the result is destroyed, at most 30 s.
    std::shared_ptr<void> keepBusy();

private:
    bool awaitRunning(bool wanted);
    void onTransition(const skill::TransitionEvent& event) override;

    SystemClock clock_;
    motion::RobotModel model_;
    std::unique_ptr<joint_simulator::JointSimulator> arm_;
    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<opcua_skill::SkillServer> skills_;
    skill::Program* program_ = nullptr;
    std::optional<robot_skills::DeviceWatch> watch_;
    std::unique_ptr<joint_simulator::SimulatorDrive> drive_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool running_ = false;
};

}  // namespace metier::client
