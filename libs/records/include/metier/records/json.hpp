#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/records/execution_row.hpp"
#include "metier/records/store.hpp"

namespace metier::records {

/// Text "2026-11-22T09:30:00.125Z"; empty for UtcTime{}, which means none. Threads: any; pure.
std::string timeText(UtcTime time);

/// A JSON object without line breaks, in UTF-8: the members of ExecutionRow by their names, times
/// as timeText() gives them (`ended` null while it is under way), `parameters`, `check` and
/// `result` as JSON, and its `duration` [s], null while it is under way. Threads: any; pure.
std::string toJson(const ExecutionRow& execution);

/// Complete record of one execution.
struct Details {
    /// The execution itself.
    ExecutionRow execution{};
    /// Executions that it started, on any server, oldest first.
    std::vector<ExecutionRow> children{};
    /// Changes of its state, in the order of their times.
    std::vector<Transition> transitions{};
    /// Values that it published, in the order of their times.
    std::vector<Intermediate> intermediates{};
    /// Positions of its arm, in the order of their times.
    std::vector<PathSample> path{};
};

/// Reads everything of one execution; waits for the store.
/// \param number ExecutionRow::number
/// Errors: not_found; those of Store.
Result<Details> detailsOf(Store& store, std::int64_t number);
/// The object of the execution with `transitions`, `intermediates`, `children` (objects as well)
/// and `path`: a list of {time, actual, commanded, force}; the last two only where there are any.
/// Threads: any; pure.
std::string toJson(const Details& details);

}  // namespace metier::records
