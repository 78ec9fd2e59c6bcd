#include "home_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace metier::robot_files {

namespace {

using motion::JointVector;
using motion::RobotModel;

constexpr int kTried = 2000;
constexpr double kMiddle = 0.7;  // share of a range

/// The van der Corput sequence: spread evenly over 0 to 1.
double spread(std::uint32_t index, std::uint32_t base) {
    double value = 0;
    double part = 1.0 / base;
    for (; index > 0; index /= base) {
        value += part * (index % base);
        part /= base;
    }
    return value;
}

JointVector candidate(const RobotModel& model, std::uint32_t index) {
    constexpr std::array<std::uint32_t, motion::kMaxAxes> primes{2, 3, 5, 7, 11, 13, 17};
    JointVector q(model.axisCount());
    for (std::size_t i = 0; i < q.size(); ++i) {
        const auto& limits = model.limits(i);
        const double middle = (limits.lower + limits.upper) / 2;
        const double reach =
            std::min(kMiddle * (limits.upper - limits.lower) / 2, std::numbers::pi / 2);
        q[i] = middle + reach * (2 * spread(index, primes[i]) - 1);
        q[i] = std::clamp(std::round(1000 * q[i]) / 1000, limits.lower, limits.upper);
    }
    return q;
}

bool isAboveBase(const RobotModel& model, const JointVector& q) {
    constexpr double rounding = 1e-6;
    const auto frames = model.kinematics().forwardAll(q);
    return std::all_of(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(q.size()) + 1,
                       [](const motion::Pose& frame) { return frame.translation.z() > -rounding; });
}

}  // namespace

JointVector searchHome(const RobotModel& model) {
    JointVector best = candidate(model, 1);
    double most = -1;
    bool above = false;
    for (std::uint32_t index = 1; index <= kTried; ++index) {
        const auto q = candidate(model, index);
        const bool is_above = isAboveBase(model, q);
        const double value = model.kinematics().smallestSingularValue(q);
        if ((is_above && !above) || (is_above == above && value > most)) {
            best = q;
            most = value;
            above = is_above;
        }
    }
    return best;
}

}  // namespace metier::robot_files
