#pragma once

#include <cstdint>
#include <string>

#include "metier/base/error.hpp"
#include "metier/records/store.hpp"

namespace metier::records {

/// Writes an execution and all executions that it started, on any server, as JSON in the Trace
/// Event Format that chrome://tracing and https://ui.perfetto.dev read.
///
/// A process stands for a server, a thread for a skill. An execution is a slice (category
/// "execution", with its parameters and result as arguments); its states are slices in it
/// ("state"), and the steps of a composed skill slices in those ("step"). Intermediate results are
/// instants; an arrow leads from an execution to each that it started. Times are microseconds since
/// the start of the execution.
/// Errors: not_found; those of Store.
/// Source: "Trace Event Format", the Chromium project.
Result<std::string> chromeTrace(Store& store, std::int64_t number);

}  // namespace metier::records
