#pragma once

#include <string_view>

#include "metier/base/error.hpp"
#include "metier/edo_driver/messages.hpp"

namespace metier::edo_driver {

/// Reads one text of the rosbridge server. What the driver does not use is Ignored; missing fields
/// keep their defaults, null is NaN, a whole number is accepted where a fraction may be, but not
/// the other way round.
///
/// Errors: invalid_argument (not JSON, wrong type, out of range, more joints than an e.DO has),
///         not_supported (a message in fragments, which the driver never asks for).
/// Does not allocate for what the robot publishes in each cycle, in its usual form.
/// Threading: any; pure.
Result<Incoming> decode(std::string_view text, const JointLayout& layout);

/// The same by a general reader of JSON, which allocates.
Result<Incoming> decodeInFull(std::string_view text, const JointLayout& layout);

}  // namespace metier::edo_driver
