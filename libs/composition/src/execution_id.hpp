#pragma once

#include <cstdint>
#include <string>

namespace metier::composition {

/// What the execution of a used skill is named after.
struct StepExecution {
    const std::string& origin;     ///< component, skill and life of the component
    const std::string& execution;  ///< of the skill that uses it
    const std::string& step;
    std::uint64_t count;
};

/// "ORIGIN/EXECUTION/STEP/COUNT", or with a hash of the execution where that is too long for an id.
std::string stepExecutionId(const StepExecution& used);

}  // namespace metier::composition
