#pragma once

#include <map>
#include <memory>
#include <string>

#include "database.hpp"

namespace metier::records {

/// A PostgreSQL database by libpqxx.
class PostgresDatabase {
public:
    /// Errors: connection_lost, with what the database said.
    static Result<std::unique_ptr<Database>> open(const std::string& url);
};

}  // namespace metier::records
