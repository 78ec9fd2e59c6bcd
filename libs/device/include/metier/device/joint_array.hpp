#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <span>

namespace metier::device {

/// Largest number of axes of one arm that a driver may have; plans have at most motion::kMaxAxes.
inline constexpr std::size_t kMaxAxes = 8;

/// One number per axis, axis 1 first: [rad] for positions, [rad/s] for velocities.
///
/// Has fixed storage and is trivially copyable: it can be handed between threads by SharedValue and
/// LatestValue, and never allocates.
///
///     JointArray home(6);                               // six zeros [rad]
///     home[1] = -1.57;                                  // axis 2
///     const JointArray copy(std::span<const double>(positions));
class JointArray {
public:
    /// No axes.
    JointArray() = default;
    /// `size` zeros; `size` <= kMaxAxes.
    /// In a release build a larger size is undefined behaviour: check sizes where values come in.
    explicit JointArray(std::size_t size) noexcept : size_(size) { assert(size <= kMaxAxes); }
    /// A copy of `values`; at most kMaxAxes of them, which is checked by assert only.
    explicit JointArray(std::span<const double> values) noexcept : JointArray(values.size()) {
        std::copy(values.begin(), values.end(), values_.begin());
    }

    /// Number of axes.
    std::size_t size() const noexcept { return size_; }
    /// Value of an axis, counted from 0; `axis` must be less than size(), which is not checked.
    /// Texts for people count axes from 1.
    double& operator[](std::size_t axis) noexcept { return values_[axis]; }
    double operator[](std::size_t axis) const noexcept { return values_[axis]; }
    /// Iterators over the values, axis 1 first.
    double* begin() noexcept { return values_.data(); }
    double* end() noexcept { return values_.data() + size_; }
    const double* begin() const noexcept { return values_.data(); }
    const double* end() const noexcept { return values_.data() + size_; }
    /// All values, axis 1 first; valid as long as this array.
    std::span<double> values() noexcept { return {values_.data(), size_}; }
    std::span<const double> values() const noexcept { return {values_.data(), size_}; }

    /// Compares sizes and values exactly; for "the same place" use largestDifference().
    bool operator==(const JointArray& other) const noexcept {
        return std::equal(begin(), end(), other.begin(), other.end());
    }

private:
    // Places from size_ on stay 0, so that two equal arrays have equal bytes.
    std::array<double, kMaxAxes> values_{};
    std::size_t size_ = 0;
};

/// Largest absolute difference of one axis between two arrays, in their unit. If their sizes
/// differ, the axes that only one has do not count.
/// 0 if one of them has no axes. Threads: any; pure, for cycle threads too.
inline double largestDifference(const JointArray& a, const JointArray& b) noexcept {
    double largest = 0.0;
    for (std::size_t axis = 0; axis < std::min(a.size(), b.size()); ++axis) {
        largest = std::max(largest, a[axis] > b[axis] ? a[axis] - b[axis] : b[axis] - a[axis]);
    }
    return largest;
}

}  // namespace metier::device
