#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace metier::ur_driver {

/// Options of the script on the controller that follows set-points.
struct ScriptOptions {
    std::int32_t register_base = 24;      ///< as in rtde::Setpoint
    std::chrono::nanoseconds cycle{};     ///< period of the set-points, > 0
    double gain = 300.0;                  ///< gain of servoj, 100 to 2000
    double lookahead = 0.1;               ///< lookahead time of servoj, 0.03 to 0.2 [s]
    double stop_deceleration = 4.0;       ///< deceleration of stopj [rad/s2]
    std::chrono::nanoseconds patience{};  ///< longest silence of the set-points
};

/// The program for the controller, in URScript, metier's own text.
///
/// It moves the arm to the set-points in the input registers for as long as the token register
/// holds `token` and the counter register changes at least once in `patience`; else it brakes with
/// stopj and ends. It writes its token and the last counter to the output registers of the same
/// numbers, and zero for the token when it ends.
/// \param token not 0
std::string servojScript(const ScriptOptions& options, std::int32_t token);

}  // namespace metier::ur_driver
