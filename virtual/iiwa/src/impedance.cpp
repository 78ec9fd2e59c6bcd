#include <cstddef>
#include <limits>

#include "robot_application.hpp"

namespace metier::virtual_iiwa {

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::max();
constexpr double kNoLimit = 1e6;

/// Range rule: this number of arguments of these impedance commands, from `first` on, must be
/// between `lower` and `upper`.
struct ImpedanceRange {
    int first_command;
    int last_command;
    std::size_t first;
    std::size_t count;
    double lower;
    double upper;
};

constexpr std::array kImpedanceRanges{
    ImpedanceRange{221, 221, 0, 3, 0.0, 5000.0},
    ImpedanceRange{221, 221, 3, 3, 0.0, 300.0},
    ImpedanceRange{221, 221, 6, 1, 0.0, kUnbounded},
    ImpedanceRange{222, 222, 0, 6, 0.1, 1.0},
    ImpedanceRange{222, 222, 6, 1, 0.3, 1.0},
    ImpedanceRange{223, 223, 0, 6, -kUnbounded, kUnbounded},
    ImpedanceRange{224, 226, 0, 6, 0.0, kUnbounded},
    ImpedanceRange{227, 227, 0, 7, 0.0, kUnbounded},
    ImpedanceRange{228, 228, 0, 7, 0.0, 1.0},
    ImpedanceRange{229, 230, 0, 6, 0.0, kUnbounded},
    ImpedanceRange{231, 232, 0, 6, -kUnbounded, kUnbounded},
    ImpedanceRange{233, 234, 0, 6, 0.0, kUnbounded},
    ImpedanceRange{235, 238, 0, 1, 0.0, kUnbounded},
    ImpedanceRange{239, 239, 0, 1, 0.0, 1.0},
    ImpedanceRange{240, 243, 0, 2, -kUnbounded, kUnbounded},
};

}  // namespace

std::array<double, 7> impedanceAfter(int code, const std::array<double, 7>& before,
                                     const std::array<double, 7>& arguments) noexcept {
    auto after = arguments;
    for (const auto& range : kImpedanceRanges) {
        if (code < range.first_command || code > range.last_command) {
            continue;
        }
        for (std::size_t i = range.first; i < range.first + range.count; ++i) {
            if (code >= 224 && code <= 226 && arguments[i] < 0.0) {
                after[i] = kNoLimit;
            } else if (!(arguments[i] >= range.lower && arguments[i] <= range.upper)) {
                after[i] = before[i];
            }
        }
    }
    return after;
}

}  // namespace metier::virtual_iiwa
