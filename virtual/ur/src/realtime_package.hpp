#pragma once

#include "robot_state.hpp"
#include "wire_bytes.hpp"

namespace metier::virtual_ur {

/// Package that port 30003 sends each cycle: 1116 bytes for software 3.10 to 3.15, 1220 bytes for
/// 5.10 and later.
/// Source: the maker's "Realtime Client Interface", versions 3.14 and 5.10.
Bytes realtimePackage(const RobotState& state, Series series);

}  // namespace metier::virtual_ur
