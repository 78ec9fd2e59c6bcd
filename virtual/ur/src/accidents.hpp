#pragma once

#include <span>
#include <string>

#include "metier/base/error.hpp"
#include "robot.hpp"

namespace metier::virtual_ur {

/// Act of a person or an accident that a robot suffers.
struct Accident {
    const char* name;
    const char* help;
    /// \param value as it was given. Errors: invalid_argument, with the range.
    Result<void> (*happen)(Robot& robot, const std::string& value);
};

/// Threading: any; pure.
std::span<const Accident> accidents();

}  // namespace metier::virtual_ur
