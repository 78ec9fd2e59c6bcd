#pragma once

#include <cstdint>
#include <string>

#include "ur_settings.hpp"

namespace metier::ur_driver {

/// The program for the controller, in URScript, metier's own text.
///
/// It moves the arm to the set-points in the input registers for as long as the token register
/// holds `token` and the counter register changes at least once in the settings' receive_timeout;
/// else it brakes with stopj and ends. It writes its token and the last counter to the output
/// registers of the same numbers, and zero for the token when it ends.
/// \param settings with a frequency > 0
/// \param token    not 0
std::string servojScript(const UrSettings& settings, std::int32_t token);

}  // namespace metier::ur_driver
