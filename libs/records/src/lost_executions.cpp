#include "lost_executions.hpp"

#include <algorithm>
#include <utility>

#include "parts.hpp"
#include "rows.hpp"
#include "text.hpp"

namespace metier::records {
namespace {

constexpr std::string_view kLostText = "the server ended while this was under way";

/// The latest time that is known of an execution under way.
Result<UtcTime> lastSignOf(Database& database, const ExecutionRow& execution) {
    METIER_ASSIGN(
        const auto rows,
        database.query(
            "SELECT events, samples FROM parts WHERE part >= $1 AND part < $2 ORDER BY part DESC "
            "LIMIT 1",
            {execution.number * kMostParts, (execution.number + 1) * kMostParts}));
    auto last = execution.started;
    if (rows.empty()) {
        return last;
    }
    std::vector<Event> events;
    decodeEvents(rows.front().text(0), events);
    for (const auto& event : events) {
        last = std::max(last, std::visit([](const auto& one) { return one.time; }, event));
    }
    std::vector<PathSample> samples;
    decodeSamples(rows.front().bytes(1), samples);
    if (!samples.empty()) {
        const std::chrono::duration<double> time(samples.back().time);
        last =
            std::max(last, execution.started + std::chrono::duration_cast<UtcTime::duration>(time));
    }
    return last;
}

Result<void> close(Database& database, const std::string& server) {
    METIER_ASSIGN(auto executions,
                  readExecutions(database, "ended = 0 AND server = $1 ORDER BY number", {server}));
    KindCache kinds;
    RowWriter writer(database, kinds);
    METIER_TRY(writer.takeRevisions(static_cast<std::int64_t>(executions.size())));
    for (auto& execution : executions) {
        METIER_ASSIGN(execution.ended, lastSignOf(database, execution));
        execution.state = kLost;
        execution.reason = kServerLost;
        execution.reason_text = kLostText;
        METIER_TRY(writer.save(execution));
    }
    return {};
}

/// Within a transaction, so that the server does not begin meanwhile.
Result<void> closeIfDead(Database& database, const std::string& server) {
    return database.isAttendedByOthers(server).and_then(
        [&](bool attended) { return attended ? Result<void>() : close(database, server); });
}

}  // namespace

Result<Presence> attend(Database& database, const std::string& server, Opening opening) {
    const auto name = storable(server, kLongestName);
    if (opening == Opening::again) {
        return database.attend(name);
    }
    Presence presence;
    return inTransaction(database,
                         [&] {
                             return closeIfDead(database, name)
                                 .and_then([&] { return database.attend(name); })
                                 .map([&](Presence held) { presence = std::move(held); });
                         })
        .map([&] { return presence; });
}

Result<void> closeLostOfOthers(Database& database, const std::string& own) {
    METIER_ASSIGN(
        const auto servers,
        database.query("SELECT DISTINCT server FROM history WHERE ended = 0 AND server <> $1",
                       {storable(own, kLongestName)}));
    for (const auto& row : servers) {
        METIER_TRY(inTransaction(database, [&] { return closeIfDead(database, row.text(0)); }));
    }
    return {};
}

}  // namespace metier::records
