#pragma once

#include "database.hpp"

namespace metier::records {

/// Of what this program writes.
inline constexpr std::int64_t kSchemaVersion = 1;

/// Makes the tables if there are none and `access` is write; else looks whether they fit.
/// Errors: not_found (no tables), invalid_argument (other tables), not_supported (later version).
Result<void> prepareSchema(Database& database, Store::Access access);

}  // namespace metier::records
