#include "metier/records/store.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <charconv>
#include <map>

#include "database.hpp"
#include "listing.hpp"
#include "parts.hpp"
#include "retention.hpp"
#include "rows.hpp"
#include "text.hpp"

namespace metier::records {
namespace {

std::optional<std::int64_t> toNumber(std::string_view text) {
    std::int64_t number = 0;
    const auto* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    return read.ec == std::errc() && read.ptr == end ? std::optional(number) : std::nullopt;
}

Result<std::vector<Execution>> executions(Database& database, std::string_view condition,
                                          std::span<const Cell> values) {
    const auto rows = database.query(
        fmt::format("SELECT {} FROM history WHERE {}", kExecutionColumns, condition), values);
    if (!rows) {
        return fail(rows.error());
    }
    std::vector<Execution> result;
    result.reserve(rows->size());
    for (const auto& row : *rows) {
        result.push_back(toExecution(row));
    }
    return result;
}

/// The column of every part of an execution, in the order in which they were written.
Result<Rows> partsOf(Database& database, std::int64_t number, std::string_view column) {
    return database.query(
        fmt::format("SELECT {} FROM parts WHERE part >= $1 AND part < $2 ORDER BY part", column),
        std::array<Cell, 2>{number * kMostParts, (number + 1) * kMostParts});
}

template <typename Wanted>
Result<std::vector<Wanted>> eventsOf(Database& database, std::int64_t number) {
    const auto rows = partsOf(database, number, "events");
    if (!rows) {
        return fail(rows.error());
    }
    std::vector<Event> events;
    for (const auto& row : *rows) {
        decodeEvents(row.text(0), events);
    }
    std::vector<Wanted> wanted;
    for (auto& event : events) {
        if (auto* one = std::get_if<Wanted>(&event)) {
            wanted.push_back(std::move(*one));
        }
    }
    return wanted;
}

}  // namespace

Store::Store(std::unique_ptr<Database> database) : database_(std::move(database)) {}
Store::~Store() = default;

Result<std::unique_ptr<Store>> Store::open(const std::string& url, Access access) {
    auto database = openDatabase(url, access);
    if (!database) {
        return fail(database.error());
    }
    return std::unique_ptr<Store>(new Store(std::move(*database)));
}

Result<Execution> Store::find(std::string_view number_or_id) {
    if (const auto number = toNumber(number_or_id)) {
        auto found = executions(*database_, "number = $1", std::array<Cell, 1>{*number});
        if (!found || !found->empty()) {
            return found ? Result<Execution>(std::move(found->front())) : fail(found.error());
        }
    }
    auto found = executions(*database_, "id = $1 ORDER BY started DESC, number DESC LIMIT 1",
                            std::array<Cell, 1>{storable(number_or_id)});
    if (!found) {
        return fail(found.error());
    }
    return found->empty() ? fail(Errc::not_found, fmt::format("{}: no execution '{}'",
                                                              database_->name(), number_or_id))
                          : Result<Execution>(std::move(found->front()));
}

Result<Listing> Store::list(const Filter& filter, const Page& page) {
    auto numbers = Search(*database_, filter, page).run();
    if (!numbers) {
        return fail(numbers.error());
    }
    Listing listing;
    const auto count = std::clamp<std::size_t>(page.count, 1, kLargestPage);
    listing.more = numbers->size() > count;
    numbers->resize(std::min(numbers->size(), count));
    if (numbers->empty()) {
        return listing;
    }
    auto found = executions(
        *database_,
        fmt::format("number IN ({}) ORDER BY started DESC, number DESC", fmt::join(*numbers, ", ")),
        {});
    if (!found) {
        return fail(found.error());
    }
    listing.executions = std::move(*found);
    return listing;
}

Result<std::vector<Execution>> Store::children(std::int64_t number) {
    const auto parent = executions(*database_, "number = $1", std::array<Cell, 1>{number});
    if (!parent) {
        return fail(parent.error());
    }
    if (parent->empty() || parent->front().id.empty()) {
        return std::vector<Execution>{};
    }
    return executions(*database_,
                      "parent = $1 AND parent <> '' AND number <> $2 AND "
                      "(parent_server = $3 OR (parent_server = '' AND server = $3)) "
                      "ORDER BY started, number",
                      std::array<Cell, 3>{parent->front().id, number, parent->front().server});
}

Result<std::vector<Transition>> Store::transitions(std::int64_t number) {
    return eventsOf<Transition>(*database_, number);
}

Result<std::vector<Intermediate>> Store::intermediates(std::int64_t number) {
    return eventsOf<Intermediate>(*database_, number);
}

Result<std::vector<PathSample>> Store::path(std::int64_t number) {
    const auto rows = partsOf(*database_, number, "samples");
    if (!rows) {
        return fail(rows.error());
    }
    std::vector<PathSample> samples;
    for (const auto& row : *rows) {
        decodeSamples(row.bytes(0), samples);
    }
    return samples;
}

Result<Changes> Store::changes(std::int64_t revision, std::uint32_t count) {
    auto found = executions(*database_, "revision > $1 ORDER BY revision LIMIT $2",
                            std::array<Cell, 2>{revision, std::int64_t{count}});
    if (!found) {
        return fail(found.error());
    }
    Changes changes{.executions = std::move(*found), .revision = revision};
    if (!changes.executions.empty()) {
        const auto last = database_->query("SELECT revision FROM executions WHERE number = $1",
                                           std::array<Cell, 1>{changes.executions.back().number});
        if (!last) {
            return fail(last.error());
        }
        changes.revision = last->empty() ? revision : last->front().integer(0);
    }
    return changes;
}

Result<std::int64_t> Store::latestRevision() {
    const auto rows =
        database_->query("SELECT value FROM metier_records WHERE name = 'revision'", {});
    return rows ? Result<std::int64_t>(rows->empty() ? 0 : rows->front().integer(0))
                : Result<std::int64_t>(fail(rows.error()));
}

Result<std::uint64_t> Store::retain(const Retention& keep, UtcTime now) {
    RetentionRun run(keep, now);
    while (true) {
        const auto more = run.step(*database_);
        if (!more) {
            return fail(more.error());
        }
        if (!*more) {
            return run.removed();
        }
    }
}

Result<std::uint64_t> Store::bytes() {
    return database_->bytes();
}

}  // namespace metier::records
