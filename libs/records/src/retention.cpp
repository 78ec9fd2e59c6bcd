#include "retention.hpp"

#include <algorithm>

#include "parts.hpp"

namespace metier::records {
namespace {

/// Removed in one transaction: others that write wait no longer than that takes.
constexpr std::uint64_t kStep = 500;

Result<void> remove(Database& database, const std::vector<std::int64_t>& numbers) {
    for (const auto number : numbers) {
        METIER_TRY(database.run("DELETE FROM parts WHERE part >= $1 AND part < $2",
                                {number * kMostParts, (number + 1) * kMostParts}));
        METIER_TRY(database.run("DELETE FROM executions WHERE number = $1", {number}));
    }
    return {};
}

Result<void> removeUnusedNotes(Database& database) {
    // Locks out those who would give a note that is about to go to a new execution.
    METIER_TRY(database.run("UPDATE metier_records SET value = value WHERE name = 'revision'"));
    return database.run(
        "DELETE FROM notes WHERE note <> 0 AND NOT EXISTS (SELECT 1 FROM executions e "
        "WHERE e.note = notes.note AND e.note <> 0)");
}

}  // namespace

Result<bool> RetentionRun::step(Database& database) {
    if (!age_done_ && keep_.age.count() > 0) {
        METIER_ASSIGN(const auto removed, removeOldest(database, now_ - keep_.age, kStep));
        age_done_ = removed < kStep;
        return true;
    }
    age_done_ = true;
    if (!excess_) {
        METIER_ASSIGN(const auto found, excess(database));
        excess_ = found;
    }
    if (*excess_ == 0) {
        return finish(database);
    }
    METIER_ASSIGN(const auto removed,
                  removeOldest(database, UtcTime::max(), std::min(kStep, *excess_)));
    excess_ = removed == 0 ? 0 : *excess_ - removed;
    return true;
}

/// Number of executions that have to go so that the rest takes nine tenths of what it may.
Result<std::uint64_t> RetentionRun::excess(Database& database) const {
    if (keep_.bytes == 0) {
        return 0;
    }
    METIER_ASSIGN(const auto used, database.number(database.dialect().bytes));
    METIER_ASSIGN(const auto all, database.number("SELECT count(*) FROM executions"));
    const double share = 1.0 - 0.9 * static_cast<double>(keep_.bytes) / static_cast<double>(used);
    return static_cast<std::uint64_t>(used) <= keep_.bytes
               ? 0
               : static_cast<std::uint64_t>(share * static_cast<double>(all)) + 1;
}

/// Executions that are over and began before that time.
/// \return how many
Result<std::uint64_t> RetentionRun::removeOldest(Database& database, UtcTime before,
                                                 std::uint64_t most) {
    METIER_ASSIGN(
        const auto old,
        database.numbers("SELECT number FROM executions WHERE started < $1 AND ended <> 0 ORDER BY "
                         "started, number LIMIT $2",
                         {toMicroseconds(before), static_cast<std::int64_t>(most)}));
    if (!old.empty()) {
        METIER_TRY(inTransaction(database, [&] { return remove(database, old); }));
    }
    removed_ += old.size();
    return std::uint64_t{old.size()};
}

/// False.
Result<bool> RetentionRun::finish(Database& database) const {
    if (removed_ == 0) {
        return false;
    }
    METIER_TRY(inTransaction(database, [&] { return removeUnusedNotes(database); }));
    METIER_TRY(database.script(std::string(database.dialect().shrink)));
    return false;
}

}  // namespace metier::records
