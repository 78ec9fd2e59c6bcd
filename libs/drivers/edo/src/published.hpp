#pragma once

#include <optional>
#include <string_view>

#include "metier/edo_driver/messages.hpp"

namespace metier::edo_driver {

/// Reads what the robot publishes in each cycle: /usb_jnt_state, /algorithm_state, /machine_state.
/// Does not allocate.
///
/// \return nothing for any other text, and for one that is in any way unusual: then decode() in
///         full. What is returned is what decode() would return.
std::optional<Incoming> readPublished(std::string_view text, const JointLayout& layout) noexcept;

}  // namespace metier::edo_driver
