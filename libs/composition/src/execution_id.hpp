#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "metier/base/stable_hash.hpp"

namespace metier::composition {

/// Parts of the id of a used skill's execution.
struct StepExecution {
    const std::string& origin;     ///< component, skill and life of the component
    const std::string& execution;  ///< id of the using skill's execution
    const std::string& step;
    std::uint64_t count;
};

/// "ORIGIN/EXECUTION/STEP/COUNT", or with a hash of the execution where that is too long for an id.
inline std::string stepExecutionId(const StepExecution& used) {
    constexpr std::size_t kLongestId = 128;
    const auto own = fmt::format("/{}/{}", used.step, used.count);
    auto above = fmt::format("{}/{}", used.origin, used.execution);
    if (above.size() + own.size() > kLongestId) {
        above = above.substr(0, used.origin.size() + 1) + fmt::format("{:016x}", stableHash(above));
    }
    return above + own;
}

}  // namespace metier::composition
