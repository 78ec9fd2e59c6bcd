#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "arm_drive.hpp"
#include "gripper_drive.hpp"
#include "metier/device/request_slot.hpp"
#include "metier/device/reset_slot.hpp"
#include "metier/device/shared_value.hpp"
#include "start_up.hpp"

namespace metier::edo_driver {

/// The dialogue with one robot, without socket and thread: texts and time go in, texts come out.
///
/// Threading: the cycle thread, but for the slots and gripperState().
class Session {
public:
    /// Both must outlive this.
    Session(const EdoOptions& options, device::ArmCore& core);

    /// A new connection: asks for the software version, then for all that the driver follows.
    void linkUp(SteadyTime now, Wire& wire);
    /// Notes that the connection is lost, or was not made; waiting requests end with that error.
    void linkDown(const std::string& why);
    /// The same for a link that the driver ends itself: no warning is logged.
    void letGo(const std::string& why);
    void onText(std::string_view text, SteadyTime now, Wire& wire);
    /// Call it at least every 20 ms.
    /// Errors: connection_lost if the robot is silent and a new connection might help.
    Result<void> tick(SteadyTime now, Wire& wire);

    /// Ends all motion: brakes and gives control back.
    void close() noexcept;
    /// Reports whether the robot has control.
    bool closed() const noexcept { return arm_.free(); }

    device::ResetSlot& resetSlot() noexcept { return reset_slot_; }
    using GripperSlot = device::RequestSlot<GripperTask, Result<device::GripperOutcome>>;
    GripperSlot& gripperSlot() noexcept { return gripper_slot_; }
    device::GripperState gripperState() const noexcept { return gripper_state_.read(); }

private:
    enum class Phase : std::uint8_t { down, asking, up };
    enum class Reset : std::uint8_t { none, freeing, giving_back, recovering };

    void on(const Ignored&, SteadyTime, Wire&) {}
    void on(const JointStates& states, SteadyTime now, Wire& wire);
    void on(const MachineState& machine, SteadyTime now, Wire& wire);
    void on(const AlgorithmState& state, SteadyTime now, Wire& wire);
    void on(const MovementFeedback& feedback, SteadyTime now, Wire& wire);
    void on(const ServiceResponse& response, SteadyTime now, Wire& wire);
    void on(const Status& status, SteadyTime now, Wire& wire);

    void begin(const Generation& generation, SteadyTime now, Wire& wire);
    void tickReset(SteadyTime now, Wire& wire);
    void startReset();
    void endReset(Result<void> outcome);
    void tickGripper(SteadyTime now, Wire& wire);
    void loseGripper(Errc code);
    void publishGripper(SteadyTime now) noexcept;
    bool valid(const JointStates& states) const noexcept;

    const EdoOptions& options_;
    device::ArmCore& core_;
    SafetyKeeper safety_;
    ArmDrive arm_;
    GripperDrive gripper_;
    StartUp start_up_;
    device::ResetSlot reset_slot_;
    GripperSlot gripper_slot_;
    device::SharedValue<device::GripperState> gripper_state_;

    Phase phase_ = Phase::down;
    Reset reset_ = Reset::none;
    bool started_once_ = false;
    bool closing_ = false;
    bool complained_ = false;  // about a text that was not understood, on this connection
    SteadyTime answer_by_{};
    SteadyTime heard_at_{};
};

}  // namespace metier::edo_driver
