#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "metier/motion/robot_model.hpp"
#include "metier/urscript/robot.hpp"
#include "robot_state.hpp"
#include "rtde_session.hpp"

namespace metier::virtual_ur {

// Packages of the ports 30001 to 30003. Every function returns one whole package.
// Source: the maker's client interface documents; the packet captured in URCL's tests.

/// Properties of the robot that do not change.
struct RobotDescription {
    Series series = Series::cb3;
    ControllerVersion version;
    std::string build_date;  ///< such as "14-12-2020, 11:11:11"
    const motion::RobotModel* model = nullptr;
    Vector6 joint_acceleration{};  ///< most of each axis [rad/s2]
    std::int32_t robot_type = 1;   ///< docs/protocols/ur.md; 1: UR5
};

/// Package type 16 with all its parts.
Bytes robotStatePackage(const RobotState& state, const RobotDescription& robot);

/// Microseconds of the controller; UINT64_MAX where the maker sends none.
using MessageTime = std::uint64_t;

MessageTime timeOf(const RobotState& state);

Bytes versionMessage(const RobotDescription& robot);
Bytes textMessage(MessageTime time, std::string_view text);
/// \param title as "PROGRAM_XXX_STARTED", at most 255 bytes
Bytes keyMessage(MessageTime time, std::string_view title, std::string_view text);
Bytes safetyModeMessage(MessageTime time, SafetyMode mode);
Bytes runtimeExceptionMessage(MessageTime time, int line, int column, std::string_view text);

/// Error in the form of the maker's log: C150A1, with a level.
struct ErrorCode {
    enum class Level : std::int32_t { debug, info, warning, violation, fault, critical };
    std::int32_t code = 0;
    std::int32_t argument = 0;
    Level level = Level::info;
    std::string text;
};
Bytes errorCodeMessage(MessageTime time, const ErrorCode& error);

/// Package that port 30003 sends each cycle: 1116 bytes for software 3.10 to 3.15, 1220 bytes for
/// 5.10 and later.
/// Source: the maker's "Realtime Client Interface", versions 3.14 and 5.10.
Bytes realtimePackage(const RobotState& state, Series series);

Bytes popupMessage(MessageTime time, const urscript::Popup& popup);

}  // namespace metier::virtual_ur
