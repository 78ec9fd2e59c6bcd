#pragma once

#include <array>
#include <string>

#include "cabinet_settings.hpp"
#include "metier/device/motion_planner.hpp"
#include "metier/iiwa_driver/wire.hpp"
#include "metier/motion/pose.hpp"

namespace metier::iiwa_driver {

/// The arm stands when no axis is faster [rad/s]: over the noise of the cabinet's differences.
inline constexpr double kStandstillSpeed = 5e-3;
bool stands(const CabinetState& state) noexcept;

/// Distance of an axis or of the flange from its target.
struct Miss {
    enum class Quantity : std::uint8_t { axis, position, rotation };
    Quantity quantity = Quantity::axis;
    std::size_t axis = 0;   ///< from 0, for an axis
    double distance = 0.0;  ///< [rad]; [m] for a position
    double limit = 0.0;     ///< the same unit
    bool within() const noexcept { return distance <= limit; }
};
/// A text such as "axis 2 0.0135 rad from its target, limit 0.0020 rad".
std::string toString(const Miss& miss);

/// End of a motion of the cabinet's planner.
struct RunEnd {
    enum class Cause : std::uint8_t {
        at_target,
        stopped,
        force,
        refused,     ///< the cabinet did not execute `command`
        not_ready,   ///< the cabinet is not ready to move
        off_target,  ///< it ended elsewhere
        stalled,     ///< it neither moved nor ended
        disconnected,
    };
    Cause cause = Cause::at_target;
    Command command{};  ///< refused command
    Miss miss{};
    int error = 0;  ///< code that the cabinet noted during the motion, 0 if none
    device::MotionOutcome outcome{};
};

/// Outcome of a controller-planned motion for its caller.
/// \param name of the device, for texts
/// \param lost why the connection is gone, for texts
/// Errors: device_fault, connection_lost
Result<device::MotionOutcome> outcomeOf(const RunEnd& end, const std::string& name,
                                        const std::string& lost);

/// One motion of the cabinet's own planner, from its settings to standstill.
///
/// Trusts no acknowledgement: the cabinet replaces values that it does not accept in silence, so
/// the end is judged by where the arm is.
/// Threading: one thread, the cycle. Nothing allocates, locks or throws.
class ControllerPlannedRun {
public:
    struct Request {
        const device::ControllerPlannedMotion& motion;
        motion::Pose flange_from_tool;  ///< tool that the cabinet's poses include
        double force_tolerance = 10.0;  ///< largest inaccuracy of the cabinet's force estimate
                                        ///< [N]
    };

    /// \param now the newest state, in which no motion is under way
    void begin(const Request& request, const CabinetState& now,
               const CabinetSettings& settings) noexcept;
    /// Brakes; the motion ends as `cause`.
    void stop(RunEnd::Cause cause) noexcept;

    /// Command to send now.
    Command command() const noexcept;
    /// Takes the answer to it. \return whether the motion is over
    /// \param step since the answer before [s]
    bool take(const Command& sent, const CabinetState& answer, double step,
              CabinetSettings& settings) noexcept;

    /// Reports whether more commands must be sent before the motion begins: they should not wait
    /// for the next cycle.
    bool hurried() const noexcept { return phase_ == Phase::telling; }
    const RunEnd& end() const noexcept { return end_; }

private:
    enum class Phase : std::uint8_t { telling, under_way, stopping };

    Command moveCommand(const Request& request) noexcept;
    void requireSettings(const Request& request, const CabinetSettings& settings) noexcept;
    bool told(const Command& sent, const CabinetState& answer, CabinetSettings& settings) noexcept;
    bool watch(const CabinetState& answer, double step) noexcept;
    bool stalls(const CabinetState& answer, double step) noexcept;
    bool brake(const CabinetState& answer, double step) noexcept;
    void note(const CabinetState& answer) noexcept;
    bool overAs(RunEnd::Cause cause) noexcept;
    Miss missOf(const CabinetState& state) const noexcept;

    Phase phase_ = Phase::telling;
    CommandList list_;
    bool by_joints_ = true;
    device::JointArray target_joints_;
    motion::Pose target_;  ///< target of the cabinet's tool
    device::JointArray start_;
    int error_before_ = 0;
    bool started_ = false;         ///< seen to move
    bool condition_new_ = false;   ///< a force condition that is met belongs to this motion
    double idle_ = 0.0;            ///< without a motion [s]
    device::JointArray progress_;  ///< position at the last progress [rad]
    double stalled_ = 0.0;         ///< time without progress since then, with a motion active [s]
    double braking_ = 0.0;         ///< [s]
    double since_cancel_ = 0.0;    ///< [s]
    bool cancelled_ = false;
    RunEnd::Cause stop_cause_ = RunEnd::Cause::stopped;
    RunEnd end_;
};

}  // namespace metier::iiwa_driver
