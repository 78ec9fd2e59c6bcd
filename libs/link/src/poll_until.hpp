#pragma once

#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::link {

/// Waits until one of `events` of poll(2) is there.
/// \param name stands before the text of an error
/// Errors: timeout; connection_lost if the descriptor is none.
Result<void> pollUntil(int descriptor, short events, SteadyTime deadline, const std::string& name);

}  // namespace metier::link
