#pragma once

#include "database.hpp"

namespace metier::records {

/// Version of the tables that this program writes.
inline constexpr std::int64_t kSchemaVersion = 1;

/// Checks the tables, or makes them if there are none and `access` is write. Any number of servers
/// may do so at once.
/// Errors: not_found (no tables), invalid_argument (other tables), not_supported (later version).
Result<void> prepareSchema(Database& database, Store::Access access);

}  // namespace metier::records
