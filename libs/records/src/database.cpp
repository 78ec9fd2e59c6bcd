#include "database.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "postgres_database.hpp"
#include "schema.hpp"
#include "sqlite_database.hpp"

namespace metier::records {
namespace {

constexpr std::string_view kSqlite = "sqlite:";

bool isPostgres(std::string_view url) {
    return url.starts_with("postgresql://") || url.starts_with("postgres://");
}

/// "sqlite:FILE", "sqlite:///FILE" or the file itself.
std::string fileOf(std::string_view url) {
    if (url.starts_with(kSqlite)) {
        url.remove_prefix(kSqlite.size());
        if (url.starts_with("///")) {
            url.remove_prefix(2);
        }
    }
    return std::string(url);
}

template <typename T>
T valueIn(const Cell& cell) {
    const auto* value = std::get_if<T>(&cell);
    return value == nullptr ? T() : *value;
}

}  // namespace

std::int64_t Row::integer(std::size_t column) const {
    return valueIn<std::int64_t>(cells_.at(column));
}

std::string Row::text(std::size_t column) const {
    return valueIn<std::string>(cells_.at(column));
}

Bytes Row::bytes(std::size_t column) const {
    return valueIn<Bytes>(cells_.at(column));
}

Result<Rows> Database::query(std::string_view sql, const std::vector<Cell>& parameters) {
    std::vector<Argument> arguments;
    for (const auto& cell : parameters) {
        std::visit([&](const auto& value) { arguments.emplace_back(value); }, cell);
    }
    return execute(sql, arguments);
}

Result<void> Database::run(std::string_view sql, const std::vector<Cell>& parameters) {
    return query(sql, parameters).map([](const Rows& /*rows*/) {});
}

Result<std::vector<std::int64_t>> Database::numbers(std::string_view sql,
                                                    const std::vector<Cell>& parameters) {
    return query(sql, parameters).map([](const Rows& rows) {
        std::vector<std::int64_t> numbers;
        std::transform(rows.begin(), rows.end(), std::back_inserter(numbers),
                       [](const Row& row) { return row.integer(0); });
        return numbers;
    });
}

Result<std::int64_t> Database::number(std::string_view sql, const std::vector<Cell>& parameters) {
    return numbers(sql, parameters).map([](const std::vector<std::int64_t>& numbers) {
        return numbers.empty() ? 0 : numbers.front();
    });
}

bool hasPassword(std::string_view url) {
    if (!isPostgres(url)) {
        return false;
    }
    url.remove_prefix(url.find("://") + 3);
    const auto options = std::min(url.find('?'), url.size());
    const auto at = url.substr(0, options).rfind('@');
    const auto user = url.substr(0, at == std::string_view::npos ? 0 : at);
    return user.find(':') != std::string_view::npos ||
           url.find("password=", options) != std::string_view::npos;
}

Result<void> checkUrl(const std::string& url) {
    if (isPostgres(url)) {
        return {};
    }
    const auto file = fileOf(url);
    if (file.empty() || file.find("://") != std::string::npos) {
        return fail(Errc::invalid_argument,
                    fmt::format("'{}': records are kept in a file, sqlite:FILE or "
                                "postgresql://USER@HOST/DATABASE",
                                url));
    }
    return {};
}

Result<std::unique_ptr<Database>> connect(const std::string& url, Store::Access access) {
    METIER_TRY(checkUrl(url));
    return isPostgres(url) ? PostgresDatabase::open(url, access)
                           : SqliteDatabase::open(fileOf(url), access);
}

Result<std::unique_ptr<Database>> openDatabase(const std::string& url, Store::Access access) {
    METIER_ASSIGN(auto database, connect(url, access));
    METIER_TRY(prepareSchema(*database, access));
    return database;
}

}  // namespace metier::records
