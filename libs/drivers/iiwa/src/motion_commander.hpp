#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "controller_planned_run.hpp"
#include "metier/device/arm_core.hpp"
#include "metier/device/motion_planner.hpp"
#include "metier/device/request_slot.hpp"
#include "metier/iiwa_driver/iiwa_arm.hpp"
#include "metier/motion/robot_model.hpp"
#include "readiness.hpp"
#include "servo_run.hpp"

namespace metier::iiwa_driver {

/// Decides which command is sent to the cabinet next, and turns its answers into the state of the
/// arm.
///
/// Threading: as each function says; the cycle thread's functions neither lock, allocate nor log
/// except where the safety state changes.
class MotionCommander {
public:
    /// \param model   must outlive the commander
    /// \param options with the tool and the force tolerance
    MotionCommander(device::ArmInfo info, const motion::RobotModel& model,
                    const IiwaOptions& options);

    device::ArmCore& core() noexcept { return core_; }
    const device::ArmCore& core() const noexcept { return core_; }

    // ---- the cycle thread ----
    /// A cabinet has answered for the first time, to askState().
    void connected(const CabinetState& first, SteadyTime now);
    /// Command to send now.
    Command command() noexcept;
    /// Takes the answer to it. \param now when it came
    void take(const Command& sent, const CabinetState& answer, SteadyTime now) noexcept;
    /// Notes that `count` cycles passed without a command.
    void missedCycles(std::uint64_t count) noexcept;
    /// Reports whether the first settings are still being sent to the cabinet.
    bool settlingIn() const noexcept { return mode_ == Mode::settling_in; }
    /// The next command should follow without waiting for the next cycle.
    bool hurried() const noexcept;
    /// Notes that the cabinet is gone, and ends the motion of the arm.
    /// \param text names the device and the reason
    void lost(const std::string& text);
    /// Reports whether dispatch() has something to report.
    bool toTell() const noexcept { return core_.toTell() || slot_.toTell(); }

    // ---- any thread ----
    Result<void> attach(std::shared_ptr<device::SetPointSource> source);
    Result<void> move(const device::ControllerPlannedMotion& motion,
                      device::MotionPlanner::Done done);
    void stopMotion() noexcept { slot_.stop(); }
    Result<void> resetFault();
    /// The notifier's thread alone.
    void dispatch();

private:
    enum class Mode : std::uint8_t { settling_in, idle, planned, servo };
    /// Why the arm may not move, the gravest last.
    enum class Condition : std::uint8_t { none, not_ready, refused_setting, latched, wrong_model };

    void settleIn() noexcept;
    void takeSettingIn(const Command& sent, const CabinetState& answer);
    void settledIn(const CabinetState& answer);
    void beginWhatIsAsked() noexcept;
    void note(const CabinetState& answer, SteadyTime now) noexcept;
    void hold(const device::JointArray& measured) noexcept;
    void takeChore(const Command& sent, const CabinetState& answer) noexcept;
    /// \return whether the motion is over
    bool takePlanned(const Command& sent, const CabinetState& answer, double step) noexcept;
    /// \return how the stream ended; nothing while it runs
    std::optional<device::EndCause> takeServo(const Command& sent, const CabinetState& answer,
                                              double step) noexcept;
    device::EndCause endServo(device::EndCause cause) noexcept;
    void latch(const ServoFault& fault);
    void judge();
    void change(Condition condition, std::string text);
    std::string lostText();

    device::ArmCore core_;
    const motion::RobotModel& model_;
    const IiwaOptions options_;
    device::RequestSlot<device::ControllerPlannedMotion, RunEnd> slot_;
    std::mutex admission_;  ///< one of attach() and move()

    // Cycle thread only:
    Mode mode_ = Mode::settling_in;
    CommandList chores_;
    CabinetSettings settings_;
    ControllerPlannedRun planned_;
    ServoRun servo_;
    Readiness readiness_;
    motion::Pose flange_from_tool_;
    CabinetState answer_;
    device::ArmState state_;
    SteadyTime last_answer_{};
    double try_again_in_ = 0.0;  ///< time until a refused setting is sent again [s]
    Condition condition_ = Condition::none;
    int skipped_ = 0;     ///< set-points to leave out next
    bool holds_ = false;  ///< the commanded position is one that was reached

    std::atomic<bool> latched_{false};
    std::mutex lost_mutex_;
    std::string lost_text_;
};

}  // namespace metier::iiwa_driver
