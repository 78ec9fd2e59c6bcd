#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/pose.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::app {

/// The numbers in some words; a word may hold several, separated by commas.
/// \param what names them in messages: "joint position"
/// Errors: invalid_argument, with the word that is not a finite number.
Result<std::vector<double>> parseNumbers(std::span<const std::string> words, std::string_view what);

/// As parseNumbers(), for one value of each axis.
/// Errors: also invalid_argument if there are not as many as axes.
Result<motion::JointVector> parseJoints(const motion::RobotModel& model,
                                        std::span<const std::string> words, std::string_view what);

/// As parseNumbers(), for x, y, z [m] and the rotations a, b, c about x, y, z [rad].
/// Errors: also invalid_argument if they are not six.
Result<motion::Pose> parsePose(std::span<const std::string> words, std::string_view what);

/// "0.1, -0.2" with 6 digits behind the point.
std::string toText(const motion::JointVector& joints);
/// Position, quaternion and rotations, a line each, for a person; 12 digits behind the point.
std::string toText(const motion::Pose& pose);

nlohmann::ordered_json toJson(const motion::JointVector& joints);
/// Objects position, quaternion and rotation; the quaternion's first component that is not 0 is
/// positive.
nlohmann::ordered_json toJson(const motion::Pose& pose);

}  // namespace metier::app
