#include "moves/path_deviation.hpp"

#include <algorithm>
#include <utility>

namespace metier::robot_skills {

PathDeviationMeter::PathDeviationMeter(motion::Trajectory trajectory, Path path) noexcept
    : trajectory_(std::move(trajectory)), path_(path) {}

double PathDeviationMeter::take(const motion::JointVector& measured) noexcept {
    const auto deviation = path_ == Path::joint_line
                               ? fromJointLine(measured)
                               : trajectory_.deviation(trajectory_.toolPose(measured));
    largest_ = std::max(largest_, deviation.distance);
    return deviation.fraction;
}

motion::PathDeviation PathDeviationMeter::fromJointLine(
    const motion::JointVector& measured) const noexcept {
    const auto start = trajectory_.start();
    const auto end = trajectory_.end();
    const auto line = end.view() - start.view();
    const double length_squared = line.squaredNorm();
    const double along = (measured.view() - start.view()).dot(line);
    const double share = length_squared > 0.0 ? std::clamp(along / length_squared, 0.0, 1.0) : 0.0;
    auto nearest = start;
    nearest.view() += share * line;
    return {motion::distanceBetween(trajectory_.toolPose(measured), trajectory_.toolPose(nearest)),
            0.0, share};
}

}  // namespace metier::robot_skills
