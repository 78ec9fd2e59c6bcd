#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/device/driver.hpp"
#include "metier/edo_driver/generation.hpp"
#include "metier/edo_driver/messages.hpp"

namespace metier::edo_driver {

using Duration = std::chrono::nanoseconds;

/// Limits of the axes that the driver assumes; the acceleration is that of its own braking.
using AxisOptions = std::vector<motion::JointLimits>;

/// Thresholds for comparing set-points with the motion of the joints.
struct FollowingOptions {
    double distance = 0.1;                           ///< largest distance from set-point to joint
                                                     ///< [rad]
    Duration time = std::chrono::milliseconds(300);  ///< time for which the distance may be larger
};

/// The gripper; believed values, see docs/protocols/edo.md.
struct GripperOptions {
    double stroke = 0.08;           ///< [m]
    double speed = 0.04;            ///< full speed of the jaws [m/s]
    double grasp_shortfall = 2e-3;  ///< jaws that stop so far from their target hold a part [m]
    double grasp_current = 0.0;     ///< a part is held only above it [A]; 0: not looked at
    Duration timeout = std::chrono::seconds(10);
};

/// Everything that a cell file says about one e.DO.
struct EdoOptions {
    std::string name;
    std::string host;
    std::uint16_t port = 9090;
    std::optional<Generation> generation{};  ///< absent: by the robot's software version
    JointLayout layout{6, true};
    std::vector<std::string> axis_names;
    AxisOptions axes;
    FollowingOptions following;
    GripperOptions gripper;
    ResetRequest reset;
    Duration joint_timeout = std::chrono::milliseconds(100);
    Duration machine_timeout = std::chrono::seconds(1);
    Duration hold_control = std::chrono::milliseconds(300);  ///< time at rest before control is
                                                             ///< given back
    bool start_on_connect = false;

    /// Period of the joint states and of the set-points.
    static constexpr Duration kCycle = std::chrono::milliseconds(10);
};

/// Reads the settings of docs/protocols/edo.md#settings.
/// Errors: invalid_argument with everything that is wrong.
Result<EdoOptions> readOptions(const device::OpenRequest& request);

}  // namespace metier::edo_driver
