#include "retention.hpp"

#include <algorithm>
#include <array>

#include "parts.hpp"

namespace metier::records {
namespace {

/// Removed in one transaction: others that write wait no longer than that takes.
constexpr std::uint64_t kStep = 500;

Result<std::uint64_t> count(Database& database) {
    const auto rows = database.query("SELECT count(*) FROM executions", {});
    return rows ? Result<std::uint64_t>(static_cast<std::uint64_t>(rows->front().integer(0)))
                : Result<std::uint64_t>(fail(rows.error()));
}

}  // namespace

Result<bool> RetentionRun::step(Database& database) {
    if (!age_done_ && keep_.age.count() > 0) {
        const auto old = oldest(database, now_ - keep_.age, kStep);
        const auto done = old ? remove(database, *old) : Result<void>(fail(old.error()));
        if (!done) {
            return fail(done.error());
        }
        age_done_ = old->size() < kStep;
        return true;
    }
    age_done_ = true;
    if (!excess_) {
        const auto found = excess(database);
        if (!found) {
            return fail(found.error());
        }
        excess_ = *found;
    }
    if (*excess_ == 0) {
        return finish(database);
    }
    const auto old = oldest(database, UtcTime::max(), std::min(kStep, *excess_));
    const auto done = old ? remove(database, *old) : Result<void>(fail(old.error()));
    if (!done) {
        return fail(done.error());
    }
    excess_ = old->empty() ? 0 : *excess_ - old->size();
    return true;
}

/// How many executions are to go so that the rest takes nine tenths of what it may.
Result<std::uint64_t> RetentionRun::excess(Database& database) const {
    if (keep_.bytes == 0) {
        return 0;
    }
    const auto used = database.bytes();
    const auto all = used ? count(database) : Result<std::uint64_t>(fail(used.error()));
    if (!all || *used <= keep_.bytes) {
        return all ? Result<std::uint64_t>(0) : all;
    }
    const double share = 1.0 - 0.9 * static_cast<double>(keep_.bytes) / static_cast<double>(*used);
    return static_cast<std::uint64_t>(share * static_cast<double>(*all)) + 1;
}

Result<Rows> RetentionRun::oldest(Database& database, UtcTime before, std::uint64_t most) const {
    return database.query(
        "SELECT number FROM executions WHERE started < $1 AND ended <> 0 ORDER BY started, number "
        "LIMIT $2",
        std::array<Cell, 2>{toMicroseconds(before), static_cast<std::int64_t>(most)});
}

Result<void> RetentionRun::remove(Database& database, const Rows& numbers) {
    if (numbers.empty()) {
        return {};
    }
    auto done = inTransaction(database, [&]() -> Result<void> {
        for (const auto& row : numbers) {
            const auto number = row.integer(0);
            const auto parts =
                database.query("DELETE FROM parts WHERE part >= $1 AND part < $2",
                               std::array<Cell, 2>{number * kMostParts, (number + 1) * kMostParts});
            const auto execution = parts
                                       ? database.query("DELETE FROM executions WHERE number = $1",
                                                        std::array<Cell, 1>{number})
                                       : parts;
            if (!execution) {
                return fail(execution.error());
            }
        }
        return {};
    });
    removed_ += done ? numbers.size() : 0;
    return done;
}

/// False.
Result<bool> RetentionRun::finish(Database& database) const {
    if (removed_ == 0) {
        return false;
    }
    const auto done = inTransaction(database, [&]() -> Result<void> {
        // Locks out who would give a note that is about to go to a new execution.
        auto rows =
            database.query("UPDATE metier_records SET value = value WHERE name = 'revision'", {});
        if (rows) {
            rows = database.query(
                "DELETE FROM notes WHERE note <> 0 AND NOT EXISTS (SELECT 1 FROM executions e "
                "WHERE e.note = notes.note AND e.note <> 0)",
                {});
        }
        return rows ? Result<void>() : Result<void>(fail(rows.error()));
    });
    const auto shrunk = done ? database.shrink() : done;
    return shrunk ? Result<bool>(false) : Result<bool>(fail(shrunk.error()));
}

}  // namespace metier::records
