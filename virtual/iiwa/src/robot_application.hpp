#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>

#include "arm.hpp"
#include "metier/motion/wrench.hpp"
#include "wire.hpp"

namespace metier::virtual_iiwa {

/// The cabinet that the robot application runs on.
struct Cabinet {
    Arm arm;
    motion::Wrench wrench{};           ///< external wrench on the flange, in the flange frame
    motion::JointVector torque_noise;  ///< noise of this cycle [Nm]
    bool emergency_stop = false;
    bool enabled = true;
    bool limit_violated = false;
    bool automatic = true;  ///< automatic mode; else T1 or T2, without a person at the enabling
                            ///< switch

    bool ready() const noexcept {
        return !emergency_stop && enabled && !limit_violated && automatic;
    }
    /// External torque on the axes [Nm].
    motion::JointVector externalTorque() const;
};

/// Value of an impedance or oscillation setting (221 to 243) in the cabinet after a command with
/// `arguments`: an entry out of its range stays as `before`, a negative limit of 224 to 226 means
/// no limit.
std::array<double, 7> impedanceAfter(int code, const std::array<double, 7>& before,
                                     const std::array<double, 7>& arguments) noexcept;

/// The robot application: what each command of the PC does.
///
/// Threading: one thread.
/// Source: libiiwa @ a17a491, java/src/application and docs/source/intro/protocol.rst.
class RobotApplication {
public:
    /// Time at which the PC gets its answer.
    enum class Answer : std::uint8_t {
        at_once,
        after_motion,     ///< synchronous: status() is right when waiting() is over
        then_no_more,     ///< this one, then none for ever
        application_ends  ///< an exception: none
    };

    /// \param cabinet outlives the application
    explicit RobotApplication(Cabinet& cabinet) : cabinet_(cabinet) {}

    Answer execute(const Command& command);
    /// Once per cycle, with how a motion ended in it.
    void step(std::optional<Arm::End> end);
    bool waiting() const noexcept { return waiting_; }
    StateNumbers state() const;
    /// A motion failed for a reason outside of it.
    void fail() noexcept;

    ErrorCode error() const noexcept { return error_; }
    bool conditionFired() const noexcept { return fired_; }
    bool servo() const noexcept { return servo_; }
    int motionType() const noexcept { return motion_type_; }
    int controlMode() const noexcept { return control_mode_; }
    bool synchronous() const noexcept { return synchronous_; }
    const std::map<int, std::array<double, 7>>& impedance() const noexcept { return impedance_; }

private:
    struct Interval {
        double lower = 0.0;
        double upper = 0.0;
    };

    bool dispatch(int code, const std::array<double, 7>& arguments);
    bool refuse(ErrorCode error) noexcept;
    bool moveJoints(const std::array<double, 7>& arguments);
    bool movePose(const std::array<double, 7>& arguments);
    bool moveCircle(const std::array<double, 7>& arguments);
    bool moveStandard(Arm::Plan plan);
    bool servoAllowed();
    bool setLimit(int code, double value);
    bool setForceCondition(const std::array<double, 7>& arguments);
    bool setTorqueCondition(const std::array<double, 7>& arguments);
    bool setMode(int code, double value);
    void setImpedance(int code, const std::array<double, 7>& arguments);
    bool attachTool(double index);
    bool conditionHolds() const;
    MovingFrame frame() const;
    motion::Pose pose() const;

    Cabinet& cabinet_;
    MotionLimits limits_;
    std::array<std::optional<double>, 3> force_thresholds_;  // [N]
    std::array<std::optional<Interval>, 7> torque_limits_;   // [Nm]
    std::map<int, std::array<double, 7>> impedance_;         // settings by their command
    motion::Pose flange_from_tool_;
    bool servo_ = false;
    bool synchronous_ = false;
    int motion_type_ = 21;
    int control_mode_ = 41;
    ErrorCode error_ = ErrorCode::none;
    bool fired_ = false;
    bool status_ = false;
    bool waiting_ = false;
    bool asked_to_move_ = false;
    bool silent_ = false;
};

}  // namespace metier::virtual_iiwa
