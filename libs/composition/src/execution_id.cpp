#include "execution_id.hpp"

#include <fmt/format.h>

#include "metier/base/stable_hash.hpp"

namespace metier::composition {

namespace {

constexpr std::size_t kLongestId = 128;
}  // namespace

std::string stepExecutionId(const StepExecution& used) {
    const auto own = fmt::format("/{}/{}", used.step, used.count);
    auto above = fmt::format("{}/{}", used.origin, used.execution);
    if (above.size() + own.size() > kLongestId) {
        above = above.substr(0, used.origin.size() + 1) + fmt::format("{:016x}", stableHash(above));
    }
    return above + own;
}

}  // namespace metier::composition
