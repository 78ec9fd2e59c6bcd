#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>

#include "metier/motion/robot_model.hpp"
#include "metier/path_evaluation/motion_curves.hpp"

namespace metier::path_evaluation {

/// Content of a picture of a motion.
struct MotionPicture {
    std::string title;  ///< any text; escaped for XML
    std::string note;   ///< a line below it
    std::span<const MotionSample> samples;
    /// Origin of the tool frame at each sample [m, base frame].
    std::span<const Eigen::Vector3d> tool_positions;
    /// Requested speed of the tool frame [m/s], drawn as a line; empty: no line.
    std::optional<double> asked_speed;
};

/// An SVG picture of a motion: joint position, velocity, acceleration and jerk as shares of their
/// limits over time, the tool frame's speed, its path in three views, and a table of the limits.
///
/// The polyline of axis 3's velocity has the classes "curve velocity axis3".
/// \param model model whose limits apply, with as many axes as the samples
/// Errors: invalid_argument (fewer than 2 samples, sizes).
Result<std::string> drawMotion(const motion::RobotModel& model, const MotionPicture& picture);

}  // namespace metier::path_evaluation
