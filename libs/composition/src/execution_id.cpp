#include "execution_id.hpp"

#include <fmt/format.h>

#include <string_view>

namespace metier::composition {

namespace {

constexpr std::size_t kLongestId = 128;
// FNV-1a, 64 bit
constexpr std::uint64_t kHashBegin = 14695981039346656037U;
constexpr std::uint64_t kHashPrime = 1099511628211U;

std::string hashOf(std::string_view text) {
    std::uint64_t hash = kHashBegin;
    for (const char letter : text) {
        hash = (hash ^ static_cast<unsigned char>(letter)) * kHashPrime;
    }
    return fmt::format("{:016x}", hash);
}

}  // namespace

std::string stepExecutionId(const StepExecution& used) {
    const auto own = fmt::format("/{}/{}", used.step, used.count);
    auto above = fmt::format("{}/{}", used.origin, used.execution);
    if (above.size() + own.size() > kLongestId) {
        above = above.substr(0, used.origin.size() + 1) + hashOf(above);
    }
    return above + own;
}

}  // namespace metier::composition
