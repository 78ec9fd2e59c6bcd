#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "database.hpp"
#include "server_locks.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace metier::records {

/// A SQLite file in WAL mode: one writes while others read.
class SqliteDatabase final : public Database {
public:
    /// Errors: as Store::open().
    static Result<std::unique_ptr<Database>> open(const std::filesystem::path& file,
                                                  Store::Access access);
    ~SqliteDatabase() override;
    SqliteDatabase(const SqliteDatabase&) = delete;
    SqliteDatabase& operator=(const SqliteDatabase&) = delete;

    const Dialect& dialect() const noexcept override;
    Result<Rows> execute(std::string_view sql, std::span<const Argument> parameters) override;
    Result<void> script(const std::string& sql) override;
    Result<void> begin() override { return script("BEGIN IMMEDIATE"); }
    Result<void> beginReading() override { return script("BEGIN"); }
    Result<void> commit() override { return script("COMMIT"); }
    void rollBack() noexcept override;
    /// Ends with what is returned alone.
    Result<Presence> attend(const std::string& server) override;
    Result<bool> isAttendedByOthers(const std::string& server) override;
    bool isCurrent() override;
    const std::string& name() const noexcept override { return name_; }

private:
    struct Close {
        void operator()(sqlite3* connection) const noexcept;
        void operator()(sqlite3_stmt* statement) const noexcept;
    };

    explicit SqliteDatabase(std::string name) : name_(std::move(name)) {}
    Result<void> connect(Store::Access access);
    Result<void> setUp(Store::Access access);
    Result<sqlite3_stmt*> prepared(std::string_view sql);
    tl::unexpected<Error> failed() const;

    std::string name_;
    std::unique_ptr<sqlite3, Close> connection_;
    // By their SQL; end before the connection.
    std::map<std::string, std::unique_ptr<sqlite3_stmt, Close>, std::less<>> statements_;
};

}  // namespace metier::records
