#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <pqxx/connection>
#include <pqxx/transaction>
#include <string>
#include <type_traits>
#include <utility>

#include "database.hpp"
#include "socket_deadline.hpp"

namespace metier::records {

/// A PostgreSQL database; all tables are in its schema "metier".
class PostgresDatabase final : public Database {
public:
    /// Errors: as Store::open().
    static Result<std::unique_ptr<Database>> open(const std::string& url, Store::Access access);

    const Dialect& dialect() const noexcept override;
    Result<Rows> execute(std::string_view sql, std::span<const Argument> parameters) override;
    Result<void> script(const std::string& sql) override;
    Result<void> begin() override;
    Result<void> beginReading() override;
    Result<void> commit() override;
    void rollBack() noexcept override;
    Result<Presence> attend(const std::string& server) override;
    Result<bool> isAttendedByOthers(const std::string& server) override;
    bool isCurrent() override { return true; }  // a connection that breaks says so
    const std::string& name() const noexcept override { return name_; }

private:
    PostgresDatabase(std::string name, const std::string& url);
    template <typename Work>
    Result<std::invoke_result_t<Work>> guarded(Work work);
    const std::string& prepared(std::string_view sql);

    std::string name_;
    std::chrono::seconds longest_call_{0};
    SocketDeadline deadline_;
    pqxx::connection connection_;
    std::unique_ptr<pqxx::dbtransaction> transaction_;            // ends before the connection
    std::map<std::string, std::string, std::less<>> statements_;  // names by their SQL
    std::uint64_t made_ = 0;                                      // statements
};

}  // namespace metier::records
