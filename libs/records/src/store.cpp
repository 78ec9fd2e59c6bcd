#include "metier/records/store.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "database.hpp"
#include "export.hpp"
#include "filter_sql.hpp"
#include "metier/base/text.hpp"
#include "parts.hpp"
#include "rows.hpp"
#include "search.hpp"
#include "text.hpp"

namespace metier::records {
namespace {

/// The column of every part of an execution, in the order in which they were written.
Result<Rows> partsOf(Database& database, std::int64_t number, std::string_view column) {
    return database.query(
        fmt::format("SELECT {} FROM parts WHERE part >= $1 AND part < $2 ORDER BY part", column),
        {number * kMostParts, (number + 1) * kMostParts});
}

template <typename Wanted>
Result<std::vector<Wanted>> eventsOf(Database& database, std::int64_t number) {
    return partsOf(database, number, "events").map([](const Rows& rows) {
        std::vector<Event> events;
        for (const auto& row : rows) {
            decodeEvents(row.text(0), events);
        }
        std::vector<Wanted> wanted;
        for (auto& event : events) {
            if (auto* one = std::get_if<Wanted>(&event)) {
                wanted.push_back(std::move(*one));
            }
        }
        return wanted;
    });
}

}  // namespace

Store::Store(std::unique_ptr<Database> database) : database_(std::move(database)) {}
Store::~Store() = default;

Result<std::unique_ptr<Store>> Store::open(const std::string& url, Access access) {
    return openDatabase(url, access).map([](std::unique_ptr<Database> database) {
        return std::unique_ptr<Store>(new Store(std::move(database)));
    });
}

Result<ExecutionRow> Store::find(std::string_view number_or_id) {
    if (const auto number = numberIn<std::int64_t>(number_or_id)) {
        auto found = readExecutions(*database_, "number = $1", {*number});
        if (!found || !found->empty()) {
            return found ? Result<ExecutionRow>(std::move(found->front())) : fail(found.error());
        }
    }
    METIER_ASSIGN(auto found,
                  readExecutions(*database_, "id = $1 ORDER BY started DESC, number DESC LIMIT 1",
                                 {storable(number_or_id)}));
    return found.empty() ? fail(Errc::not_found, fmt::format("{}: no execution '{}'",
                                                             database_->name(), number_or_id))
                         : Result<ExecutionRow>(std::move(found.front()));
}

Result<Listing> Store::list(const Filter& filter, const Page& page) {
    METIER_ASSIGN(auto numbers, Search(*database_, filter, page).run());
    Listing listing;
    const auto count = std::clamp<std::size_t>(page.count, 1, kLargestPage);
    listing.more = numbers.size() > count;
    numbers.resize(std::min(numbers.size(), count));
    if (numbers.empty()) {
        return listing;
    }
    const auto condition =
        fmt::format("number IN ({}) ORDER BY started DESC, number DESC", fmt::join(numbers, ", "));
    return readExecutions(*database_, condition).map([&](std::vector<ExecutionRow> found) {
        listing.executions = std::move(found);
        return listing;
    });
}

Result<std::vector<ExecutionRow>> Store::children(std::int64_t number) {
    METIER_ASSIGN(const auto parent, readExecutions(*database_, "number = $1", {number}));
    if (parent.empty() || parent.front().id.empty()) {
        return std::vector<ExecutionRow>{};
    }
    return readExecutions(*database_,
                          "parent = $1 AND parent <> '' AND number <> $2 AND "
                          "(parent_server = $3 OR (parent_server = '' AND server = $3)) "
                          "ORDER BY started, number",
                          {parent.front().id, number, parent.front().server});
}

Result<std::vector<Transition>> Store::transitions(std::int64_t number) {
    return eventsOf<Transition>(*database_, number);
}

Result<std::vector<Intermediate>> Store::intermediates(std::int64_t number) {
    return eventsOf<Intermediate>(*database_, number);
}

Result<std::vector<PathSample>> Store::path(std::int64_t number) {
    return partsOf(*database_, number, "samples").map([](const Rows& rows) {
        std::vector<PathSample> samples;
        for (const auto& row : rows) {
            decodeSamples(row.bytes(0), samples);
        }
        return samples;
    });
}

Result<Changes> Store::changes(std::int64_t revision, const Filter& filter, std::uint32_t count) {
    METIER_ASSIGN(const auto latest, latestRevision());
    Values values({revision, latest, std::int64_t{count}});
    const auto condition = fits(filter, values);
    METIER_ASSIGN(
        auto found,
        readExecutions(
            *database_,
            fmt::format("revision > $1 AND revision <= $2 AND {} ORDER BY revision LIMIT $3",
                        condition),
            values.all()));
    Changes changes{.executions = std::move(found), .revision = latest};
    if (changes.executions.size() < count) {
        return changes;
    }
    return database_
        ->number("SELECT revision FROM executions WHERE number = $1",
                 {changes.executions.back().number})
        .map([&](std::int64_t last) {
            changes.revision = last;
            return changes;
        });
}

Result<std::int64_t> Store::latestRevision() {
    return database_->number("SELECT value FROM metier_records WHERE name = 'revision'");
}

Result<std::uint64_t> Store::bytes() {
    return database_->number(database_->dialect().bytes).map([](std::int64_t bytes) {
        return static_cast<std::uint64_t>(bytes);
    });
}

Result<std::uint64_t> Store::exportTo(const std::string& file) {
    return records::exportTo(*database_, file);
}

bool Store::isCurrent() {
    return database_->isCurrent();
}

}  // namespace metier::records
