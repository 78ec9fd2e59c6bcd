#pragma once

#include "cabinet_settings.hpp"
#include "metier/device/arm.hpp"
#include "metier/iiwa_driver/wire.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::iiwa_driver {

/// Why a set-point or the arm's answer to it ends a stream.
struct ServoFault {
    enum class Kind : std::uint8_t {
        position,       ///< a set-point outside the axis' range
        step,           ///< a set-point farther from the one before than the axis can go
        not_finite,     ///< a set-point
        not_following,  ///< the arm does not follow its set-points
        refused,        ///< the cabinet did not execute a command
    };
    Kind kind = Kind::position;
    std::size_t axis = 0;  ///< from 0
    double value = 0.0;    ///< [rad]
    double limit = 0.0;    ///< [rad]
    Command command{};     ///< refused command
};
std::string toString(const ServoFault& fault);

/// One stream of set-points to the cabinet's servo interface.
///
/// Compares what it sends with where the arm is, since the cabinet replaces set-points that it does
/// not accept in silence.
/// Threading: one thread, the cycle. Nothing allocates, locks or throws.
class ServoRun {
public:
    enum class Status : std::uint8_t { running, done, stopped, fault };

    /// \param model must outlive the run
    /// \param cycle of the set-points [s]
    ServoRun(const motion::RobotModel& model, double cycle) noexcept
        : model_(&model), cycle_(cycle) {}

    /// \param start where the arm is commanded to stand [rad]
    void begin(const device::JointArray& start, const CabinetSettings& settings) noexcept;
    /// Brakes; ends as `stopped` at standstill.
    void stop() noexcept;

    /// Command to send now; asks the source for a set-point when one is due.
    /// \param cycles since the last set-point, >= 1: so many are asked for, the last is sent
    Command command(device::SetPointSource& source, const device::ArmState& state,
                    int cycles) noexcept;
    /// Takes the answer to it. \param step since the answer before [s]
    Status take(const Command& sent, const CabinetState& answer, double step,
                CabinetSettings& settings) noexcept;

    /// Reports whether more commands must be sent before the first set-point.
    bool hurried() const noexcept { return phase_ == Phase::entering; }
    /// The last set-point sent [rad].
    const device::JointArray& commanded() const noexcept { return commanded_; }
    const ServoFault& fault() const noexcept { return fault_; }

private:
    enum class Phase : std::uint8_t { entering, following, done, faulty, stopping };

    Command follow(device::SetPointSource& source, const device::ArmState& state,
                   int cycles) noexcept;
    bool accept(const device::JointArray& set_point) noexcept;
    bool refuse(const ServoFault& fault) noexcept;
    Status enter(const Command& sent, const CabinetState& answer,
                 CabinetSettings& settings) noexcept;
    bool follows(const CabinetState& answer, double step) noexcept;
    Status rest(const CabinetState& answer) const noexcept;

    const motion::RobotModel* model_;
    double cycle_;
    Phase phase_ = Phase::entering;
    CommandList list_;
    device::JointArray commanded_;
    double behind_ = 0.0;  ///< time for which the arm has been too far from its set-points [s]
    bool cancelled_ = false;
    ServoFault fault_;
};

}  // namespace metier::iiwa_driver
