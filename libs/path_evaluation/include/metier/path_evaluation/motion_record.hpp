#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/joint_vector.hpp"

namespace metier::path_evaluation {

/// Where the axes were at one time.
struct RecordedPosition {
    double time = 0;  ///< [s], from any origin
    motion::JointVector position;
};

/// A motion as it was recorded: at least kFewestRecorded positions of the same size, times growing.
using MotionRecord = std::vector<RecordedPosition>;
inline constexpr std::size_t kFewestRecorded = 5;

/// Reads a record from CSV or JSON; which of them is seen from its first character.
///
/// CSV: a line `time,q1,...,qn` for each position, [s] and [rad]; a first line that does not begin
/// with a number is a heading, lines that begin with # are passed over. JSON: a list of objects
/// with `time` and `joint_position`, or an object that has such a list as `preview`.
/// \param name stands for the file in messages
/// Errors: invalid_argument, with name, line or position, and what is wrong.
Result<MotionRecord> parseRecord(std::string_view text, std::string_view name);
/// The same of a file. Errors: also not_found.
Result<MotionRecord> loadRecord(const std::filesystem::path& file);

/// The record as CSV, every number with all its digits.
std::string toCsv(const MotionRecord& record);

}  // namespace metier::path_evaluation
