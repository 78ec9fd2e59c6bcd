#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/motion/trajectory.hpp"
#include "metier/path_evaluation/motion_record.hpp"

namespace metier::path_evaluation {

/// State of all axes at one instant; all vectors have the same size.
struct MotionSample {
    /// Time after the start [s].
    double time = 0;
    /// Joint position [rad].
    motion::JointVector position;
    /// Joint velocity [rad/s].
    motion::JointVector velocity;
    /// Joint acceleration [rad/s2].
    motion::JointVector acceleration;
    /// Joint jerk [rad/s3].
    motion::JointVector jerk;
};

/// Samples of a planned motion at equal times, both ends included. Position, velocity and
/// acceleration are the planned ones; the jerk is the mean over one sample's time.
/// \param count >= 2
std::vector<MotionSample> sampleMotion(const motion::Trajectory& trajectory, std::size_t count);

/// A recorded motion; its derivatives are those of a cubic fitted to seven positions around each.
/// \param record a record from parseRecord()
std::vector<MotionSample> sampleMotion(const MotionRecord& record);

/// Quantity of a sample.
enum class Quantity { position, velocity, acceleration, jerk };

/// That quantity of all axes; valid as long as the sample.
const motion::JointVector& valuesOf(const MotionSample& sample, Quantity quantity) noexcept;

/// A value as a share of its limit: -1 and 1 are the limits. For a position 0 is half way between
/// its limits.
double shareOfLimit(const motion::JointLimits& limits, Quantity quantity, double value) noexcept;

/// Moment at which an axis came nearest to its limit, or went farthest beyond it.
struct Peak {
    std::size_t axis = 0;  ///< from 0
    double share = 0;      ///< share of the limit, >= 0
    double value = 0;      ///< in the quantity's unit
    double time = 0;       ///< [s]
};
/// The highest peak of all axes; zeros without samples.
Peak peakOf(std::span<const MotionSample> samples, const motion::RobotModel& model,
            Quantity quantity);
/// The highest peak of one axis, counted from 0.
Peak peakOfAxis(std::span<const MotionSample> samples, const motion::RobotModel& model,
                Quantity quantity, std::size_t axis);

}  // namespace metier::path_evaluation
