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
/// What a column holds. The schema knows no NULL.
using Cell = std::variant<std::int64_t, std::string, Bytes>;
/// A parameter of a statement; refers to what outlives its execution.
using Argument = std::variant<std::int64_t, std::string_view, std::span<const std::uint8_t>>;

/// That a server is there; what it is differs between databases.
using Presence = std::shared_ptr<const void>;

/// A row of an answer. Columns are read as what the query made them.
class Row {
public:
    explicit Row(std::vector<Cell> cells) : cells_(std::move(cells)) {}

    std::int64_t integer(std::size_t column) const;
    std::string text(std::size_t column) const;
    Bytes bytes(std::size_t column) const;

private:
    std::vector<Cell> cells_;
};
using Rows = std::vector<Row>;

/// What differs between the SQL of databases.
struct Dialect {
    std::string_view number_key;  ///< type of a primary key that counts by itself
    std::string_view blob;
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
    Result<Rows> query(std::string_view sql, std::span<const Cell> parameters);
    /// An INSERT of one row into a table with a key that counts by itself, of the name `key`.
    /// \return the key
    virtual Result<std::int64_t> insert(std::string_view sql, std::string_view key,
                                        std::span<const Argument> parameters) = 0;
    /// Several statements without parameters.
    virtual Result<void> script(const std::string& sql) = 0;
    /// A transaction that writes; others that write wait until its end.
    virtual Result<void> begin() = 0;
    virtual Result<void> commit() = 0;
    /// Also after an error; does nothing without a transaction.
    virtual void rollBack() noexcept = 0;
    /// Tells others that this process records for that server: as long as what is returned lives,
    /// and, unless that is said otherwise, the connection.
    virtual Result<Presence> attend(const std::string& server) = 0;
    /// Whether another Presence does.
    virtual Result<bool> isAttendedByOthers(const std::string& server) = 0;
    /// Whether that table is there.
    virtual Result<bool> hasTable(std::string_view name) = 0;
    /// Whether there is any table at all.
    virtual Result<bool> isEmpty() = 0;
    /// What executions and their parts take.
    virtual Result<std::uint64_t> bytes() = 0;
    /// Gives back what removed rows took, as far as it can.
    virtual Result<void> shrink() = 0;
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

/// Runs `work` in a transaction: committed if it succeeds, else rolled back.
template <typename Work>
Result<void> inTransaction(Database& database, Work work) {
    if (auto begun = database.begin(); !begun) {
        database.rollBack();
        return begun;
    }
    auto done = work();
    if (done) {
        done = database.commit();
    }
    if (!done) {
        database.rollBack();
    }
    return done;
}

}  // namespace metier::records
