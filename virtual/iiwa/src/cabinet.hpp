#pragma once

#include "arm.hpp"
#include "metier/motion/twist.hpp"

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

}  // namespace metier::virtual_iiwa
