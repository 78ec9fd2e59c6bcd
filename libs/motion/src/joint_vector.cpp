#include "metier/motion/joint_vector.hpp"

#include <algorithm>
#include <cmath>

namespace metier::motion {

JointVector::JointVector(std::initializer_list<double> values) noexcept
    : size_(std::min(values.size(), kMaxAxes)) {
    std::copy_n(values.begin(), size_, values_.begin());
}

Result<JointVector> JointVector::from(std::span<const double> values) {
    if (values.size() > kMaxAxes) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} axes, at most {}", values.size(), kMaxAxes));
    }
    JointVector result(values.size());
    std::copy(values.begin(), values.end(), result.begin());
    if (!result.allFinite()) {
        return fail(Errc::invalid_argument, "a joint value is not finite");
    }
    return result;
}

JointVector JointVector::constant(std::size_t size, double value) noexcept {
    JointVector result(size);
    std::fill(result.begin(), result.end(), value);
    return result;
}

bool JointVector::allZero() const noexcept {
    return std::all_of(begin(), end(), [](double value) { return value == 0.0; });
}

bool JointVector::allFinite() const noexcept {
    return std::all_of(begin(), end(), [](double value) { return std::isfinite(value); });
}

bool operator==(const JointVector& a, const JointVector& b) noexcept {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

double maxDifference(const JointVector& a, const JointVector& b) noexcept {
    double largest = 0;
    for (std::size_t axis = 0; axis < a.size(); ++axis) {
        largest = std::max(largest, std::abs(a[axis] - b[axis]));
    }
    return largest;
}

}  // namespace metier::motion
