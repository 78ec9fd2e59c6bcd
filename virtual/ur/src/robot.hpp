#pragma once

#include <asio/io_context.hpp>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "metier/virtual_controller/controller.hpp"
#include "program_runner.hpp"
#include "robot_options.hpp"
#include "script_sockets.hpp"

namespace metier::virtual_ur {

/// The virtual robot with its controller, without the ports.
///
/// Threading: the thread that runs the io_context.
class Robot {
public:
    /// Surroundings of the robot; all of them must outlive it.
    struct Surroundings {
        asio::io_context& context;
        virtual_controller::LinkFaults& faults;
        virtual_controller::WorldLink& world;
        /// Gets each message of the primary port.
        std::function<void(const Bytes&)> tell;
    };
    Robot(RobotOptions options, Surroundings around);
    Robot(const Robot&) = delete;
    Robot& operator=(const Robot&) = delete;

    /// One period of the controller.
    void cycle();
    /// Restarts as after power was switched off and on.
    void restart();

    const RobotState& state() const { return state_; }
    const RobotOptions& options() const { return options_; }
    double rate() const { return rate_; }

    // ---- for RTDE ----
    RtdeInputs rtdeInputs() { return {state_.inputs, control_}; }
    void inputsWritten(const std::vector<std::string>& names);

    // ---- for the script ports ----
    /// A program, or one of the lines that those ports take besides: "power on", "stop program".
    void takeScript(std::string_view text);
    void tellText(std::string_view text);

    // ---- for the dashboard; what changes something fails with invalid_state if it may not ----
    const RobotModes& modes() const { return *modes_; }
    ProgramRunner& programs() { return *programs_; }
    bool commandsAllowed() const;
    Result<void> powerOn() { return modes_->powerOn(); }
    Result<void> releaseBrakes() { return modes_->releaseBrakes(); }
    void powerOff();
    Result<void> unlock() { return modes_->unlock(); }
    void restartSafety();
    Result<void> play();
    void showPopup(std::string text);
    void closePopup() { script_robot_->closePopup(); }

    // ---- for injections ----
    void emergencyStop();
    void releaseEmergencyStop() { modes_->releaseEmergencyStop(); }
    void protectiveStop(const ArmViolation& cause);
    /// Someone opens or closes the safeguard: the program is paused.
    void safeguardStop();
    void closeSafeguard() { modes_->closeSafeguard(); }
    /// An axis is outside of its safety limits, the program ends; or it was moved back.
    void enterRecovery();
    void endRecovery() { modes_->endRecovery(); }
    /// The safety system finds something that must not be: power goes off.
    void violateSafety();
    /// \param axis from 0
    void exceedLimit(std::size_t axis);
    void setControl(Control control) { control_mode_ = control; }
    Control control() const { return control_mode_; }

private:
    void begin();
    void stopEverything();
    void doAsked();
    void watchSafety();
    void applyControlInputs();
    void publish();
    void publishTool();
    void publishModes();
    bool takeCommandLine(std::string_view line);

    const RobotOptions options_;
    Surroundings around_;
    const double rate_;  // cycles per second
    RobotState state_;
    ControlInputs control_;
    Control control_mode_;
    // Requests of programs in this cycle: carried out when no program is running its step, since
    // they may end programs.
    struct Asked {
        bool power_down = false;
        bool protective_stop = false;
    };
    Asked asked_;
    Arm arm_;
    ScriptSockets sockets_;
    std::optional<RobotModes> modes_;
    std::optional<ScriptRobot> script_robot_;
    std::optional<ProgramRunner> programs_;
    SafetyMode published_safety_ = SafetyMode::normal;
};

/// Acts of persons and accidents that a robot suffers.
///
/// \param robot outlives them
std::vector<virtual_controller::InjectionHelp> accidentsOf(Robot& robot);

}  // namespace metier::virtual_ur
