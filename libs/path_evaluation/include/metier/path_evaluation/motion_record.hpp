#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/joint_vector.hpp"

namespace metier::path_evaluation {

/// Joint position at one time.
struct RecordedPosition {
    double time = 0;  ///< time [s], from any origin
    /// Joint position [rad], axis 1 first.
    motion::JointVector position;
};

/// A recorded motion: at least kFewestRecorded positions of the same size, with growing times.
using MotionRecord = std::vector<RecordedPosition>;
/// Smallest number of positions from which derivatives can be computed.
inline constexpr std::size_t kFewestRecorded = 5;

/// Reads a record from CSV or JSON; the first character decides which of them it is. Threads: any;
/// pure.
///
/// CSV: a line `time,q1,...,qn` for each position, [s] and [rad]; a first line that does not begin
/// with a number is a heading, lines that begin with # are skipped. JSON: a list of objects with
/// `time` and `joint_position`, or an object that has such a list as `preview`.
/// \param name name of the file in messages
/// Errors: invalid_argument, with name, line or position, and the error.
Result<MotionRecord> parseRecord(std::string_view text, std::string_view name);
/// The same from a file. Errors: also not_found.
Result<MotionRecord> loadRecord(const std::filesystem::path& file);

/// The record as CSV, every number with all its digits.
std::string toCsv(const MotionRecord& record);

}  // namespace metier::path_evaluation
