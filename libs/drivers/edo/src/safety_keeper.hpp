#pragma once

#include <optional>
#include <string>

#include "metier/device/arm_core.hpp"
#include "options.hpp"

namespace metier::edo_driver {

/// Collects all reasons that may forbid motion, and gives the most serious one to the arm's core.
///
/// Threading: one thread. tick() does not allocate unless something changes.
class SafetyKeeper {
public:
    /// \param options, core must outlive this
    SafetyKeeper(const EdoOptions& options, device::ArmCore& core)
        : options_(options), core_(core) {}

    /// Nothing is known of the robot any more.
    void linkLost(const std::string& why);
    /// The link is open; the robot has not answered the first requests yet.
    void linkFound(SteadyTime now);
    /// Sets the reason why this driver cannot use this robot; it stays until the link ends.
    void unusable(const std::string& why);
    void onMachineState(const MachineState& machine, SteadyTime now);
    /// \param count of joints in the message
    void onJointStates(std::size_t count, SteadyTime now);
    /// Judges silence.
    void tick(SteadyTime now);

    enum class Limit : std::uint8_t { kept, violated };
    /// The driver itself stopped the arm; until clearFault().
    void fault(const std::string& why, Limit limit = Limit::kept);
    void clearFault();
    bool hasFault() const noexcept { return !fault_.empty(); }

    /// Last machine state from the robot; nothing before the first one.
    const std::optional<MachineState>& machine() const noexcept { return machine_; }
    /// Reports whether the robot itself lets the joints move, whatever other reasons the driver
    /// has.
    bool robotAllowsMotion() const noexcept { return robot_allows_; }
    bool jointsSilent() const noexcept { return joints_silent_; }

private:
    void tell();
    device::Safety gravest() const;
    device::Safety silence() const;

    const EdoOptions& options_;
    device::ArmCore& core_;
    std::optional<std::string> link_problem_{"not connected yet"};
    std::optional<std::string> unusable_;
    std::optional<MachineState> machine_;
    device::Safety robot_;  // safety by machine_
    bool robot_allows_ = false;
    std::size_t joint_count_ = 0;
    bool machine_silent_ = true;
    bool joints_silent_ = true;
    SteadyTime machine_heard_{};
    SteadyTime joints_heard_{};
    std::string fault_;
    Limit limit_ = Limit::kept;
    device::Safety reported_{device::SafetyState::disconnected, {}, false};
};

}  // namespace metier::edo_driver
