#pragma once

#include <optional>
#include <string_view>

#include "metier/edo_driver/messages.hpp"

namespace metier::edo_driver {

/// Reads what the robot publishes in each cycle: /usb_jnt_state, /algorithm_state, /machine_state.
/// Does not allocate.
///
/// \return the same as decode() for this text; nothing for another text or one that is in any way
///         unusual: call decode() then
std::optional<Incoming> readPublished(std::string_view text, const JointLayout& layout) noexcept;

}  // namespace metier::edo_driver
