#include "metier/path_evaluation/motion_curves.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace metier::path_evaluation {
namespace {

using motion::JointVector;
using motion::Seconds;
using motion::Trajectory;

constexpr std::size_t kWindow = 7;
constexpr int kCoefficients = 4;  // number of coefficients of a cubic
/// Over less time a difference of accelerations is rounding only [s].
constexpr double kShortest = 1e-7;

/// Mean jerk from `from` to `to` [s].
JointVector meanJerk(const Trajectory& trajectory, double from, double to) {
    JointVector jerk(trajectory.axisCount());
    if (to - from > kShortest) {
        const auto before = trajectory.sample(Seconds(from)).acceleration;
        const auto after = trajectory.sample(Seconds(to)).acceleration;
        jerk.view() = (after.view() - before.view()) / (to - from);
    }
    return jerk;
}

/// The positions around one of a record, to which a cubic is fitted.
std::span<const RecordedPosition> windowAround(const MotionRecord& record, std::size_t index) {
    const std::size_t size = std::min(kWindow, record.size());
    const std::size_t first =
        index < size / 2 ? 0 : std::min(index - size / 2, record.size() - size);
    return std::span(record).subspan(first, size);
}

MotionSample sampleOf(const MotionRecord& record, std::size_t index) {
    const auto window = windowAround(record, index);
    const auto& [time, position] = record[index];
    // Times in half windows, so that the fit is as well conditioned at 1 kHz as at 1 Hz.
    const double unit = (window.back().time - window.front().time) / 2;
    const auto rows = static_cast<Eigen::Index>(window.size());
    const auto axes = static_cast<Eigen::Index>(position.size());
    Eigen::MatrixXd powers(rows, kCoefficients);
    Eigen::MatrixXd positions(rows, axes);
    for (Eigen::Index row = 0; row < rows; ++row) {
        const auto& recorded = window[static_cast<std::size_t>(row)];
        const double t = (recorded.time - time) / unit;
        powers.row(row) << 1, t, t * t, t * t * t;
        positions.row(row) = recorded.position.view().transpose();
    }
    const Eigen::MatrixXd cubic = powers.householderQr().solve(positions);
    const JointVector zero(position.size());
    MotionSample sample{time - record.front().time, position, zero, zero, zero};
    sample.velocity.view() = cubic.row(1).transpose() / unit;
    sample.acceleration.view() = 2 * cubic.row(2).transpose() / (unit * unit);
    sample.jerk.view() = 6 * cubic.row(3).transpose() / (unit * unit * unit);
    return sample;
}

}  // namespace

std::vector<MotionSample> sampleMotion(const Trajectory& trajectory, std::size_t count) {
    const double duration = trajectory.duration().count();
    const double step = duration / static_cast<double>(std::max<std::size_t>(count, 2) - 1);
    std::vector<MotionSample> samples;
    samples.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double time = std::min(step * static_cast<double>(i), duration);
        const auto point = trajectory.sample(Seconds(time));
        samples.push_back({time, point.position, point.velocity, point.acceleration,
                           meanJerk(trajectory, std::max(time - step / 2, 0.0),
                                    std::min(time + step / 2, duration))});
    }
    return samples;
}

std::vector<MotionSample> sampleMotion(const MotionRecord& record) {
    std::vector<MotionSample> samples;
    samples.reserve(record.size());
    for (std::size_t i = 0; i < record.size(); ++i) {
        samples.push_back(sampleOf(record, i));
    }
    return samples;
}

const JointVector& valuesOf(const MotionSample& sample, Quantity quantity) noexcept {
    switch (quantity) {
        case Quantity::position:
            return sample.position;
        case Quantity::velocity:
            return sample.velocity;
        case Quantity::acceleration:
            return sample.acceleration;
        case Quantity::jerk:
            break;
    }
    return sample.jerk;
}

double shareOfLimit(const motion::JointLimits& limits, Quantity quantity, double value) noexcept {
    switch (quantity) {
        case Quantity::position:
            return (2 * value - limits.lower - limits.upper) / (limits.upper - limits.lower);
        case Quantity::velocity:
            return value / limits.velocity;
        case Quantity::acceleration:
            return value / limits.acceleration;
        case Quantity::jerk:
            break;
    }
    return value / limits.jerk;
}

Peak peakOfAxis(std::span<const MotionSample> samples, const motion::RobotModel& model,
                Quantity quantity, std::size_t axis) {
    Peak peak{.axis = axis};
    for (const auto& sample : samples) {
        const double value = valuesOf(sample, quantity)[axis];
        const double share = std::abs(shareOfLimit(model.limits(axis), quantity, value));
        if (share > peak.share) {
            peak = {axis, share, value, sample.time};
        }
    }
    return peak;
}

Peak peakOf(std::span<const MotionSample> samples, const motion::RobotModel& model,
            Quantity quantity) {
    Peak highest;
    for (std::size_t axis = 0; axis < model.axisCount(); ++axis) {
        const auto peak = peakOfAxis(samples, model, quantity, axis);
        if (peak.share > highest.share) {
            highest = peak;
        }
    }
    return highest;
}

}  // namespace metier::path_evaluation
