#pragma once

#include <string>
#include <utility>

#include "database.hpp"

namespace metier::records {

/// Commits and does not hear that it did, once.
class DeafDatabase final : public Database {
public:
    explicit DeafDatabase(Database& database) : database_(database) {}

    const Dialect& dialect() const noexcept override { return database_.dialect(); }
    Result<Rows> execute(std::string_view sql, std::span<const Argument> parameters) override {
        return database_.execute(sql, parameters);
    }
    Result<std::int64_t> insert(std::string_view sql, std::string_view key,
                                std::span<const Argument> parameters) override {
        return database_.insert(sql, key, parameters);
    }
    Result<void> script(const std::string& sql) override { return database_.script(sql); }
    Result<void> begin() override { return database_.begin(); }
    Result<void> commit() override {
        auto done = database_.commit();
        return std::exchange(heard_, false) ? Result<void>(fail(Errc::connection_lost, "deaf"))
                                            : done;
    }
    void rollBack() noexcept override { database_.rollBack(); }
    Result<Presence> attend(const std::string& server) override { return database_.attend(server); }
    Result<bool> isAttendedByOthers(const std::string& server) override {
        return database_.isAttendedByOthers(server);
    }
    Result<bool> hasTable(std::string_view name) override { return database_.hasTable(name); }
    Result<bool> isEmpty() override { return database_.isEmpty(); }
    Result<std::uint64_t> bytes() override { return database_.bytes(); }
    Result<void> shrink() override { return database_.shrink(); }
    const std::string& name() const noexcept override { return database_.name(); }

private:
    Database& database_;
    bool heard_ = true;
};

}  // namespace metier::records
