#include "export.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <filesystem>
#include <limits>
#include <system_error>

#include "schema.hpp"
#include "sqlite_database.hpp"

namespace metier::records {
namespace {

namespace fs = std::filesystem;

/// Rows that are read at once.
constexpr std::int64_t kRowsAtOnce = 500;

/// A table and the number that its rows are read by.
struct Copied {
    std::string_view table;
    std::string_view key;
};
constexpr std::array kCopied{Copied{"kinds", "kind"}, Copied{"notes", "note"},
                             Copied{"executions", "number"}, Copied{"parts", "part"}};

Result<void> insert(Database& into, std::string_view table, const Rows& rows) {
    for (const auto& row : rows) {
        std::vector<std::string> parameters;
        for (std::size_t i = 1; i <= row.cells().size(); ++i) {
            parameters.push_back(fmt::format("${}", i));
        }
        const auto sql =
            fmt::format("INSERT INTO {} VALUES ({})", table, fmt::join(parameters, ", "));
        METIER_TRY(into.run(sql, row.cells()));
    }
    return {};
}

/// The key is the first column of every table.
Result<void> copy(Database& from, Database& into, const Copied& copied) {
    const auto sql = fmt::format("SELECT * FROM {0} WHERE {1} > $1 ORDER BY {1} LIMIT $2",
                                 copied.table, copied.key);
    std::int64_t last = std::numeric_limits<std::int64_t>::min();
    while (true) {
        METIER_ASSIGN(const auto rows, from.query(sql, {last, kRowsAtOnce}));
        if (rows.empty()) {
            return {};
        }
        METIER_TRY(insert(into, copied.table, rows));
        last = rows.back().integer(0);
    }
}

Result<void> copyTables(Database& from, Database& into) {
    for (const auto& copied : kCopied) {
        METIER_TRY(copy(from, into, copied));
    }
    return {};
}

/// The version comes last, with all before it on the disk: a file that was left half written is no
/// store of records. No file beside it has a part of it.
Result<void> copyAll(Database& from, Database& into) {
    METIER_TRY(
        into.script("DELETE FROM metier_records; DELETE FROM notes; PRAGMA journal_mode = OFF;"
                    "PRAGMA synchronous = OFF; PRAGMA cache_size = -65536"));
    METIER_TRY(inTransaction(into, [&] { return copyTables(from, into); }));
    METIER_TRY(into.script("PRAGMA journal_mode = DELETE; PRAGMA synchronous = FULL"));
    METIER_ASSIGN(const auto rows, from.query("SELECT name, value FROM metier_records"));
    return inTransaction(into, [&] { return insert(into, "metier_records", rows); });
}

Result<std::uint64_t> writeFile(Database& from, const std::string& file) {
    METIER_ASSIGN(const auto opened, SqliteDatabase::open(file, Store::Access::write));
    auto& into = *opened;
    METIER_TRY(prepareSchema(into, Store::Access::write));
    METIER_TRY(inSnapshot(from, [&] { return copyAll(from, into); }));
    METIER_ASSIGN(const auto count, into.number("SELECT count(*) FROM executions"));
    return static_cast<std::uint64_t>(count);
}

}  // namespace

Result<std::uint64_t> exportTo(Database& from, const std::string& file) {
    std::error_code none;
    if (fs::symlink_status(file, none).type() != fs::file_type::not_found) {
        return fail(Errc::already_exists,
                    fmt::format("{} exists already: it is left as it is", file));
    }
    auto count = writeFile(from, file);
    for (const auto* more : {"", "-wal", "-shm"}) {
        if (!count) {
            fs::remove(file + more, none);
        }
    }
    return count;
}

}  // namespace metier::records
