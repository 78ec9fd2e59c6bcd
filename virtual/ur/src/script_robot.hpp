#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "arm.hpp"
#include "metier/urscript/robot.hpp"
#include "robot_state.hpp"
#include "script_sockets.hpp"

namespace metier::virtual_ur {

/// The virtual robot as programs see it.
///
/// Threading: one thread, the cycle.
class ScriptRobot final : public urscript::Robot {
public:
    struct Parts {
        Arm& arm;
        RobotState& state;
        ScriptSockets& sockets;
        double cycle = 0.008;  ///< [s]
        std::function<void(const std::string&)> text_message;
        std::function<void(const urscript::Popup&)> popup;
        std::function<void()> power_down;
        std::function<void()> protective_stop;
    };
    explicit ScriptRobot(Parts parts);

    /// Before programs run in a cycle: what they see is of this instant.
    void beginCycle();
    /// After they ran: brakes if a motion was abandoned and no other was begun.
    void endCycle();
    /// Begins the motion anew that the controller's own stop ended.
    void resumeMotion();
    /// Ends what belongs to a program: force mode, watchdogs, sockets.
    void endProgram();
    void closePopup() { popup_open_ = false; }

    /// Clients wrote inputs of these names.
    void inputsWritten(const std::vector<std::string>& names);
    /// Action that a watchdog demands now: "pause" or "stop"; empty: none.
    std::string watch();

    double stepTime() const override { return parts_.cycle; }
    const urscript::RobotState& state() const override { return seen_; }
    Result<Vector6> jointPositionHistory(int cycles) const override;
    Result<void> beginMotion(const urscript::Motion& motion) override;
    Result<bool> motionDone() override { return parts_.arm.motionDone(); }
    void abandonMotion() override;
    Result<void> apply(const urscript::Command& command) override;
    int toolContact(const Vector6& direction) const override;
    Result<Vector6> inverseKinematics(const urscript::Pose& base_from_tool, const Vector6& near,
                                      const urscript::Pose& flange_from_tool) const override;
    Result<urscript::Pose> forwardKinematics(const Vector6& joint_position,
                                             const urscript::Pose& flange_from_tool) const override;
    bool withinLimits(const urscript::Target& target) const override;
    urscript::Pose targetWaypoint() const override;
    Result<std::int32_t> integerRegister(urscript::RegisterBank which, int index) const override;
    Result<double> floatRegister(urscript::RegisterBank which, int index) const override;
    Result<bool> bitRegister(urscript::RegisterBank which, int index) const override;
    Result<void> writeIntegerRegister(int index, std::int32_t value) override;
    Result<void> writeFloatRegister(int index, double value) override;
    Result<void> writeBitRegister(int index, bool value) override;
    Result<bool> digitalInput(urscript::DigitalPort port, int index) const override;
    Result<bool> digitalOutput(urscript::DigitalPort port, int index) const override;
    Result<void> setDigitalOutput(urscript::DigitalPort port, int index, bool value) override;
    Result<double> analogInput(urscript::AnalogPort port, int index) const override;
    Result<double> analogOutput(urscript::AnalogPort port, int index) const override;
    Result<void> setAnalogOutput(urscript::AnalogPort port, int index, double share) override;
    void textMessage(const std::string& text) override { parts_.text_message(text); }
    void showPopup(const urscript::Popup& popup) override;
    bool popupOpen() const override { return popup_open_; }
    urscript::Sockets& sockets() override { return parts_.sockets; }

private:
    struct Watchdog {
        double period = 0.0;  // [s]
        double silent = 0.0;  // [s]
        std::string action;
    };
    void setTool(const motion::Pose& flange_from_tool);
    const Registers& bank(urscript::RegisterBank which) const;

    Parts parts_;
    urscript::RobotState seen_;
    std::optional<urscript::Motion> motion_;  // motion that was begun last
    bool abandoned_ = false;
    bool popup_open_ = false;
    std::uint64_t contact_since_ = 0;  // cycle; 0: no contact
    std::map<std::string, Watchdog, std::less<>> watchdogs_;
};

}  // namespace metier::virtual_ur
