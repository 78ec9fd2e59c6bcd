#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <span>

#include "metier/base/error.hpp"

namespace metier::motion {

/// Largest number of axes of a robot that motions can be planned for; arms may have
/// device::kMaxAxes.
inline constexpr std::size_t kMaxAxes = 7;

/// One value per axis, axis 1 first: joint positions [rad], velocities [rad/s] and so on.
/// At most kMaxAxes values; trivially copyable, never allocates.
///
///     const JointVector home{0.0, -1.57, 1.57, 0.0, 0.0, 0.0};  // [rad]
///     const auto target = JointVector::from(client_values);      // a Result: checked
///     const double way = maxDifference(home, *target);           // [rad]
class JointVector {
public:
    /// No axes.
    JointVector() = default;
    /// \param size <= kMaxAxes, which is not checked; all values 0
    explicit JointVector(std::size_t size) noexcept : size_(size) {}
    /// \param values at most kMaxAxes; more are dropped
    JointVector(std::initializer_list<double> values) noexcept;

    /// Copies values that were not checked before, such as those of a client.
    /// Errors: invalid_argument if there are more than kMaxAxes values or one is not finite.
    static Result<JointVector> from(std::span<const double> values);
    /// Makes a vector with `value` for each of `size` axes; size <= kMaxAxes.
    static JointVector constant(std::size_t size, double value) noexcept;

    /// Number of axes.
    std::size_t size() const noexcept { return size_; }
    /// Whether it has no axes, as in an optional limit that was not given.
    bool empty() const noexcept { return size_ == 0; }
    /// Value of an axis, counted from 0; `axis` must be less than size(), which is not checked.
    double operator[](std::size_t axis) const noexcept { return values_[axis]; }
    double& operator[](std::size_t axis) noexcept { return values_[axis]; }
    /// Iterators over the values, axis 1 first.
    double* begin() noexcept { return values_.data(); }
    double* end() noexcept { return values_.data() + size_; }
    const double* begin() const noexcept { return values_.data(); }
    const double* end() const noexcept { return values_.data() + size_; }
    /// All values, axis 1 first; valid as long as this vector.
    std::span<const double> span() const noexcept { return {values_.data(), size_}; }

    /// Views of the values without a copy; valid as long as this vector.
    using View = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxAxes, 1>>;
    using ConstView = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxAxes, 1>>;
    /// The same values for arithmetic with Eigen.
    View view() noexcept { return {values_.data(), static_cast<Eigen::Index>(size_)}; }
    ConstView view() const noexcept { return {values_.data(), static_cast<Eigen::Index>(size_)}; }

    /// Reports whether every value is 0; true if there are no values.
    /// Exact; -0.0 counts as 0.
    bool allZero() const noexcept;
    /// Reports whether no value is infinite or NaN.
    bool allFinite() const noexcept;
    /// Compares sizes and values exactly; for "the same place" use maxDifference().
    friend bool operator==(const JointVector& a, const JointVector& b) noexcept;

private:
    std::array<double, kMaxAxes> values_{};
    std::size_t size_ = 0;
};

/// Largest absolute difference of two positions of the same size, in their unit; 0 without axes.
/// Threads: any; pure, for cycle threads too.
double maxDifference(const JointVector& a, const JointVector& b) noexcept;

}  // namespace metier::motion
