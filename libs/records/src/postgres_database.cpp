#include "postgres_database.hpp"

namespace metier::records {

Result<std::unique_ptr<Database>> PostgresDatabase::open(const std::string& url) {
    return fail(Errc::not_supported, url + ": not built with PostgreSQL");
}

}  // namespace metier::records
