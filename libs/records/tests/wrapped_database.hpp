#pragma once

#include <functional>
#include <span>
#include <string>
#include <utility>

#include "database.hpp"

namespace metier::records {

/// Does what another one does.
class WrappedDatabase : public Database {
public:
    explicit WrappedDatabase(Database& database) : database_(database) {}

    const Dialect& dialect() const noexcept override { return database_.dialect(); }
    Result<Rows> execute(std::string_view sql, std::span<const Argument> parameters) override {
        return database_.execute(sql, parameters);
    }
    Result<void> script(const std::string& sql) override { return database_.script(sql); }
    Result<void> begin() override { return database_.begin(); }
    Result<void> beginReading() override { return database_.beginReading(); }
    Result<void> commit() override { return database_.commit(); }
    void rollBack() noexcept override { database_.rollBack(); }
    Result<Presence> attend(const std::string& server) override { return database_.attend(server); }
    Result<bool> isAttendedByOthers(const std::string& server) override {
        return database_.isAttendedByOthers(server);
    }
    bool isCurrent() override { return database_.isCurrent(); }
    const std::string& name() const noexcept override { return database_.name(); }

private:
    Database& database_;
};

/// Commits, but reports a failure, once.
class DeafDatabase final : public WrappedDatabase {
public:
    using WrappedDatabase::WrappedDatabase;
    Result<void> commit() override {
        auto done = WrappedDatabase::commit();
        return std::exchange(heard_, false) ? Result<void>(fail(Errc::connection_lost, "deaf"))
                                            : done;
    }

private:
    bool heard_ = true;
};

/// A database that another writer changes right after the first look at it, unless a transaction
/// that writes keeps others out.
class RacedDatabase final : public WrappedDatabase {
public:
    RacedDatabase(Database& database, std::function<void()> somebody)
        : WrappedDatabase(database), somebody_(std::move(somebody)) {}
    Result<void> begin() override {
        somebody_ = nullptr;
        return WrappedDatabase::begin();
    }
    Result<Rows> execute(std::string_view sql, std::span<const Argument> parameters) override {
        auto seen = WrappedDatabase::execute(sql, parameters);
        if (const auto somebody = std::exchange(somebody_, nullptr)) {
            somebody();
        }
        return seen;
    }

private:
    std::function<void()> somebody_;
};

}  // namespace metier::records
