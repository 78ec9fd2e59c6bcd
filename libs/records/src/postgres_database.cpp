#include "postgres_database.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <pqxx/nontransaction>
#include <pqxx/pqxx>

#include "metier/base/stable_hash.hpp"

namespace metier::records {
namespace {

constexpr Dialect kPostgres{
    .number_key = "BIGSERIAL PRIMARY KEY",
    .blob = "BYTEA",
    .tables = "SELECT tablename::text FROM pg_tables WHERE schemaname = 'metier'",
    // Only rows that are there: a table keeps the space of removed ones for new ones.
    .bytes =
        "SELECT (SELECT coalesce(sum(pg_column_size(e.*)), 0) FROM executions e)::bigint + "
        "(SELECT coalesce(sum(pg_column_size(p.*)), 0) FROM parts p)::bigint",
    .shrink = ""};  // autovacuum does
constexpr std::size_t kMostPrepared = 64;
/// For one statement. A database that hangs does not keep its own deadline, so that the connection
/// is cut a little later.
constexpr std::chrono::seconds kLongestStatement{30};
constexpr std::chrono::seconds kLongestQuery{10};
constexpr std::chrono::seconds kGrace{5};
/// Any number that others do not use: who writes records holds this lock.
constexpr std::string_view kLock = "SELECT pg_advisory_xact_lock(5641903277)";
/// As well; the second number is a server's.
constexpr int kServerLocks = 564190;
/// Types of columns, as pg_type has them.
enum TypeOid : unsigned { type_bytea = 17, type_int8 = 20, type_int2 = 21, type_int4 = 23 };

/// Longest waits of a connection, unless its URL says otherwise: the network may hang.
constexpr std::array kDeadlines{std::pair{"connect_timeout", "5"},
                                std::pair{"tcp_user_timeout", "10000"},
                                std::pair{"keepalives_idle", "10"}};

// SQLSTATEs.
constexpr std::string_view kLockNotAvailable = "55P03";
constexpr std::string_view kQueryCanceled = "57014";

/// The URL with deadlines for whatever its user did not set.
std::string withDeadlines(std::string url) {
    for (const auto& [name, value] : kDeadlines) {
        if (url.find(name) == std::string::npos) {
            url +=
                fmt::format("{}{}={}", url.find('?') == std::string::npos ? '?' : '&', name, value);
        }
    }
    return url;
}

/// Without user, password and options.
std::string nameOf(std::string_view url) {
    const auto begin = url.find("://") + 3;
    auto rest = url.substr(begin, url.find('?', begin) - begin);
    if (const auto at = rest.rfind('@'); at != std::string_view::npos) {
        rest.remove_prefix(at + 1);
    }
    return fmt::format("postgresql://{}", rest);
}

std::string toHex(std::span<const std::uint8_t> bytes) {
    std::string text = "\\x";
    text.reserve(2 + 2 * bytes.size());
    for (const auto byte : bytes) {
        fmt::format_to(std::back_inserter(text), "{:02x}", byte);
    }
    return text;
}

std::string toParameter(const Argument& argument) {
    if (const auto* number = std::get_if<std::int64_t>(&argument)) {
        return std::to_string(*number);
    }
    const auto* text = std::get_if<std::string_view>(&argument);
    return text != nullptr ? std::string(*text)
                           : toHex(std::get<std::span<const std::uint8_t>>(argument));
}

Bytes fromHex(std::string_view text) {
    Bytes bytes;
    for (std::size_t i = 2; i + 1 < text.size(); i += 2) {
        std::uint8_t byte = 0;
        std::from_chars(text.data() + i, text.data() + i + 2, byte, 16);
        bytes.push_back(byte);
    }
    return bytes;
}

Cell toCell(const pqxx::field& field, unsigned type) {
    const std::string_view text(field.c_str(), field.size());
    if (type == type_bytea) {
        return fromHex(text);
    }
    if (type != type_int8 && type != type_int4 && type != type_int2) {
        return std::string(text);
    }
    std::int64_t number = 0;
    std::from_chars(text.data(), text.data() + text.size(), number);
    return number;
}

Rows toRows(const pqxx::result& result) {
    Rows rows;
    rows.reserve(static_cast<std::size_t>(result.size()));
    for (const auto& row : result) {
        std::vector<Cell> cells;
        for (const auto& field : row) {
            cells.push_back(toCell(field, field.type()));
        }
        rows.emplace_back(std::move(cells));
    }
    return rows;
}

/// Whether others held it up; the connection is as good as before.
bool isTimeout(std::string_view state) {
    return state == kLockNotAvailable || state == kQueryCanceled;
}

/// The first line of what libpqxx says, which ends with the statement.
std::string firstLine(const std::exception& error) {
    const std::string_view text(error.what());
    return std::string(text.substr(0, text.find('\n')));
}

}  // namespace

/// Turns what libpqxx throws into an error.
template <typename Work>
Result<std::invoke_result_t<Work>> PostgresDatabase::guarded(Work work) {
    const auto armed = deadline_.arm(connection_.sock(), longest_call_ + kGrace);
    try {
        if constexpr (std::is_void_v<decltype(work())>) {
            work();
            return {};
        } else {
            return work();
        }
    } catch (const pqxx::broken_connection& error) {
        return fail(Errc::connection_lost, fmt::format("{}: {}", name_, firstLine(error)));
    } catch (const pqxx::sql_error& error) {
        return fail(isTimeout(error.sqlstate()) ? Errc::timeout : Errc::resource_unavailable,
                    fmt::format("{}: {}", name_, firstLine(error)));
    } catch (const std::exception& error) {
        return fail(Errc::internal, fmt::format("{}: {}", name_, firstLine(error)));
    }
}

PostgresDatabase::PostgresDatabase(std::string name, const std::string& url)
    : name_(std::move(name)), connection_(withDeadlines(url)) {}

Result<std::unique_ptr<Database>> PostgresDatabase::open(const std::string& url,
                                                         Store::Access access) {
    std::unique_ptr<PostgresDatabase> database;
    try {
        database.reset(new PostgresDatabase(nameOf(url), url));
    } catch (const std::exception& error) {
        return fail(Errc::connection_lost, fmt::format("{}: {}", nameOf(url), firstLine(error)));
    }
    database->longest_call_ = access == Store::Access::write ? kLongestStatement : kLongestQuery;
    auto done = database->script(fmt::format(
        "SET client_min_messages = warning; SET client_encoding = 'UTF8'; SET search_path TO "
        "metier; SET bytea_output = 'hex'; SET lock_timeout = '5s'; SET statement_timeout = '{}s'",
        database->longest_call_.count()));
    if (done && access == Store::Access::write) {
        auto& made = *database;
        done = inTransaction(made,
                             [&made] { return made.script("CREATE SCHEMA IF NOT EXISTS metier"); });
    } else if (done) {
        done = database->script("SET default_transaction_read_only = on");
    }
    return done ? Result<std::unique_ptr<Database>>(std::move(database)) : fail(done.error());
}

const Dialect& PostgresDatabase::dialect() const noexcept {
    return kPostgres;
}

const std::string& PostgresDatabase::prepared(std::string_view sql) {
    if (const auto known = statements_.find(sql); known != statements_.end()) {
        return known->second;
    }
    if (statements_.size() >= kMostPrepared) {
        for (const auto& [text, name] : statements_) {
            connection_.unprepare(name);
        }
        statements_.clear();
    }
    const auto name = fmt::format("metier_{}", ++made_);
    connection_.prepare(name, std::string(sql));
    return statements_.emplace(std::string(sql), name).first->second;
}

Result<Rows> PostgresDatabase::execute(std::string_view sql, std::span<const Argument> parameters) {
    std::vector<std::string> texts;
    std::transform(parameters.begin(), parameters.end(), std::back_inserter(texts), toParameter);
    const auto values = pqxx::prepare::make_dynamic_params(texts);
    return guarded([&] {
        const auto& name = prepared(sql);
        if (transaction_ != nullptr) {
            return toRows(transaction_->exec_prepared(name, values));
        }
        pqxx::nontransaction alone(connection_);
        return toRows(alone.exec_prepared(name, values));
    });
}

Result<void> PostgresDatabase::script(const std::string& sql) {
    return guarded([&] {
        if (transaction_ != nullptr) {
            transaction_->exec(sql);
        } else {
            pqxx::nontransaction(connection_).exec(sql);
        }
    });
}

Result<void> PostgresDatabase::begin() {
    return guarded([&] {
        transaction_ = std::make_unique<pqxx::work>(connection_);
        transaction_->exec(std::string(kLock));
    });
}

Result<void> PostgresDatabase::beginReading() {
    return guarded([&] {
        transaction_ = std::make_unique<pqxx::work>(connection_);
        transaction_->exec("SET TRANSACTION ISOLATION LEVEL REPEATABLE READ READ ONLY");
    });
}

Result<void> PostgresDatabase::commit() {
    return guarded([&] {
        transaction_->commit();
        transaction_.reset();
    });
}

void PostgresDatabase::rollBack() noexcept {
    transaction_.reset();  // aborts; logs nothing and throws nothing
}

Result<Presence> PostgresDatabase::attend(const std::string& server) {
    const auto hash = static_cast<std::int32_t>(stableHash(server));
    return run(fmt::format("SELECT pg_advisory_lock_shared({}, {})", kServerLocks, hash)).map([] {
        return Presence();
    });
}

Result<bool> PostgresDatabase::isAttendedByOthers(const std::string& server) {
    const auto hash = static_cast<std::int32_t>(stableHash(server));
    // An exclusive lock can be taken only if no other session holds it; it is given back at once.
    return number(fmt::format("SELECT CASE WHEN pg_try_advisory_lock({0}, {1}) THEN "
                              "pg_advisory_unlock({0}, {1}) ELSE false END::int",
                              kServerLocks, hash))
        .map([](std::int64_t alone) { return alone == 0; });
}

}  // namespace metier::records
