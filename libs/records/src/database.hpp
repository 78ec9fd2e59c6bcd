#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/records/store.hpp"

namespace metier::records {

using Bytes = std::vector<std::uint8_t>;
/// Content of a column. The schema knows no NULL.
using Cell = std::variant<std::int64_t, std::string, Bytes>;
/// A parameter of a statement; refers to what outlives its execution.
using Argument = std::variant<std::int64_t, std::string_view, std::span<const std::uint8_t>>;

/// Sign that a server is there; its type differs between databases.
using Presence = std::shared_ptr<const void>;

/// A row of an answer. Columns are read as what the query made them.
class Row {
public:
    explicit Row(std::vector<Cell> cells) : cells_(std::move(cells)) {}

    std::int64_t integer(std::size_t column) const;
    std::string text(std::size_t column) const;
    Bytes bytes(std::size_t column) const;
    const std::vector<Cell>& cells() const noexcept { return cells_; }

private:
    std::vector<Cell> cells_;
};
using Rows = std::vector<Row>;

/// SQL that differs between databases.
struct Dialect {
    std::string_view number_key;  ///< type of a primary key that counts by itself
    std::string_view blob;
    std::string_view tables;  ///< statement: names of all tables
    std::string_view bytes;   ///< statement: space of executions and their parts
    std::string_view shrink;  ///< statements: give back the space of removed rows, if one can
};

/// A connection to a database that takes SQL.
///
/// Parameters are $1, $2, ...; Threading: one thread at a time.
class Database {
public:
    virtual ~Database() = default;
    virtual const Dialect& dialect() const noexcept = 0;
    /// Errors: those of Store.
    virtual Result<Rows> execute(std::string_view sql, std::span<const Argument> parameters) = 0;
    Result<Rows> query(std::string_view sql, const std::vector<Cell>& parameters = {});
    /// Runs a statement without an answer.
    Result<void> run(std::string_view sql, const std::vector<Cell>& parameters = {});
    /// First column of each row.
    Result<std::vector<std::int64_t>> numbers(std::string_view sql,
                                              const std::vector<Cell>& parameters = {});
    /// First column of the first row; 0: there is none.
    Result<std::int64_t> number(std::string_view sql, const std::vector<Cell>& parameters = {});
    /// Several statements without parameters.
    virtual Result<void> script(const std::string& sql) = 0;
    /// A transaction that writes; others that write wait until its end.
    virtual Result<void> begin() = 0;
    /// A transaction that reads: it sees the store as it is now until its end.
    virtual Result<void> beginReading() = 0;
    virtual Result<void> commit() = 0;
    /// Also after an error; does nothing without a transaction.
    virtual void rollBack() noexcept = 0;
    /// Shows others that this process records for that server: as long as what is returned lives,
    /// and, unless that is said otherwise, the connection.
    virtual Result<Presence> attend(const std::string& server) = 0;
    /// Whether another Presence does.
    virtual Result<bool> isAttendedByOthers(const std::string& server) = 0;
    /// Whether the connection leads to the store that others would open now.
    virtual bool isCurrent() = 0;
    /// For messages: the file, or host and database; no password.
    virtual const std::string& name() const noexcept = 0;
};

/// With the tables of the schema.
/// Errors: as Store::open().
Result<std::unique_ptr<Database>> openDatabase(const std::string& url, Store::Access access);
/// Errors: as Store::open(). Looks at no table.
Result<std::unique_ptr<Database>> connect(const std::string& url, Store::Access access);
/// Whether connect() knows that form.
Result<void> checkUrl(const std::string& url);

/// Runs `work` in a transaction that was begun: committed if it succeeds, else rolled back.
template <typename Work>
Result<void> untilCommit(Database& database, Result<void> begun, Work work) {
    auto done = begun ? work() : begun;
    if (done) {
        done = database.commit();
    }
    if (!done) {
        database.rollBack();
    }
    return done;
}

/// Runs `work` in a transaction that writes.
template <typename Work>
Result<void> inTransaction(Database& database, Work work) {
    return untilCommit(database, database.begin(), work);
}

/// Runs `work`, which reads, while the store seems not to change.
template <typename Work>
Result<void> inSnapshot(Database& database, Work work) {
    return untilCommit(database, database.beginReading(), work);
}

}  // namespace metier::records
