#pragma once

#include <cstdint>
#include <string>

namespace metier::composition {

/// Parts of the id of a used skill's execution.
struct StepExecution {
    const std::string& origin;     ///< component, skill and life of the component
    const std::string& execution;  ///< id of the using skill's execution
    const std::string& step;
    std::uint64_t count;
};

/// "ORIGIN/EXECUTION/STEP/COUNT", or with a hash of the execution where that is too long for an id.
std::string stepExecutionId(const StepExecution& used);

}  // namespace metier::composition
