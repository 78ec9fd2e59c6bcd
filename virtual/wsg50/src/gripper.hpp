#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "jaws.hpp"
#include "protocol.hpp"

namespace metier::virtual_wsg50 {

/// Abilities of the gripper: the maker's data of a WSG 50 110.
struct Capability {
    double stroke = 0.110;           ///< [m]
    double min_speed = 0.005;        ///< [m/s]
    double max_speed = 0.420;        ///< [m/s]
    double min_acceleration = 0.1;   ///< [m/s2]
    double max_acceleration = 5.0;   ///< [m/s2]
    double min_force = 5.0;          ///< [N]
    double nominal_force = 80.0;     ///< [N]
    double overdrive_force = 120.0;  ///< [N]
    double clamping_travel = 0.003;  ///< grasps from the nominal width to so much beside it [m]
    double homing_speed = 0.1;       ///< [m/s]
    double start_width = 0.055;      ///< width when power is switched on [m]
};

struct SoftLimits {
    double minus = 0.0;  ///< [m]
    double plus = 0.0;   ///< [m]
};

/// Behaviour of pre-position when an obstacle is in the way.
enum class WhenBlocked : std::uint8_t { clamp, stop };

enum class HomingDirection : std::uint8_t { standard = 0, positive = 1, negative = 2 };

/// The gripper behind the wire: modes, limits, faults, and the jaws.
///
/// Motion commands return pending, or the reason why not; OnFinished reports the end of each once.
/// Threading: one thread.
class Gripper {
public:
    using OnFinished = std::function<void(Command command, Status status)>;

    Gripper(const Capability& capability, OnFinished on_finished);

    Status home(HomingDirection direction);
    /// \param target width, absolute [m]; \param speed [m/s]
    Status prePosition(double target, double speed, WhenBlocked when_blocked);
    Status grasp(double nominal_width, double speed);
    Status release(double opening_width, double speed);

    void stop();
    void fastStop();
    /// Ends the faults whose cause is gone.
    void acknowledge();

    Status setAcceleration(double acceleration);  ///< [m/s2]
    Status setForceLimit(double force);           ///< [N]
    Status setSoftLimits(SoftLimits limits);      ///< [m]
    void clearSoftLimits() { soft_limits_.reset(); }
    void setOverdrive(bool on);
    void setTemperatureFault(bool present);
    void resetStatistics() { cycles_since_reset_ = aborted_since_reset_ = 0; }

    void step(double seconds, const Obstacles& obstacles);

    const Capability& capability() const noexcept { return capability_; }
    double width() const noexcept { return jaws_.width(); }        ///< [m]
    double velocity() const noexcept { return jaws_.velocity(); }  ///< [m/s]
    double force() const noexcept;                                 ///< [N]
    double acceleration() const noexcept { return jaws_.acceleration; }
    double forceLimit() const noexcept { return force_limit_; }
    SoftLimits softLimits() const noexcept;
    GraspingState graspingState() const noexcept { return state_; }
    std::uint32_t systemState() const noexcept;
    bool referenced() const noexcept { return referenced_; }
    bool fault() const noexcept { return fast_stop_ || temperature_fault_; }
    double temperature() const noexcept { return hot_ ? 92.0 : 38.5; }  ///< [deg C]
    std::uint32_t cycles() const noexcept { return cycles_; }
    std::uint16_t cyclesSinceReset() const noexcept { return cycles_since_reset_; }
    std::uint16_t abortedSinceReset() const noexcept { return aborted_since_reset_; }

private:
    struct Motion {
        Command command = Command::stop;
        double nominal = 0.0;  // nominal width of a grasp [m]
        WhenBlocked when_blocked = WhenBlocked::stop;
    };

    Status permit(double width, double speed) const;
    Status begin(const Motion& motion, double target, double speed);
    void abort();
    void finish(Status status, GraspingState state);
    void arrive();
    void meet();
    void watchPart();

    Capability capability_;
    OnFinished on_finished_;
    Jaws jaws_;
    std::optional<Motion> motion_;
    GraspingState state_ = GraspingState::idle;
    Jaws::Contact blocked_ = Jaws::Contact::none;  // contact at which it stopped, blocked
    std::optional<SoftLimits> soft_limits_;
    double force_limit_;
    bool referenced_ = false;
    bool overdrive_ = false;
    bool fast_stop_ = false;
    bool hot_ = false;
    bool temperature_fault_ = false;
    bool axis_stopped_ = false;
    bool target_reached_ = false;
    std::uint32_t cycles_ = 0;
    std::uint16_t cycles_since_reset_ = 0;
    std::uint16_t aborted_since_reset_ = 0;
};

}  // namespace metier::virtual_wsg50
