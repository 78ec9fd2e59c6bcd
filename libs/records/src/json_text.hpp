#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "metier/records/execution_row.hpp"

namespace metier::records {

/// The value that a text of JSON has; the text itself if it is none, null if it is empty.
nlohmann::ordered_json parsed(const std::string& text);
nlohmann::ordered_json jsonOf(const ExecutionRow& execution);
/// Without line breaks; what is no UTF-8 is replaced.
std::string dump(const nlohmann::ordered_json& json);

}  // namespace metier::records
