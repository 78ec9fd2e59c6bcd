#include "presence.hpp"

#include <array>
#include <functional>
#include <utility>

#include "backlog.hpp"
#include "text.hpp"
#include "writer.hpp"

namespace metier::records {
namespace {

/// Each step in a transaction of its own, so that the server does not begin meanwhile, and that
/// those who write need not wait for all of them.
/// \param last done in the last one, also if the server is there
Result<Dropped> closeIfDead(Database& database, const std::string& server, Recorder::ToJson to_json,
                            const std::function<Result<void>()>& last) {
    Recovery recovery(server, to_json);
    bool more = true;
    while (more) {
        const auto done = inTransaction(database, [&]() -> Result<void> {
            const auto attended = database.isAttendedByOthers(server);
            const auto stepped =
                attended && !*attended ? recovery.step(database) : Result<bool>(false);
            if (!attended || !stepped) {
                return fail(attended ? stepped.error() : attended.error());
            }
            more = *stepped;
            if (more) {
                return {};
            }
            auto closed = *attended ? Result<void>() : Writer::closeLost(database, server);
            return closed ? last() : closed;
        });
        if (!done) {
            return fail(done.error());
        }
    }
    return recovery.lost();
}

}  // namespace

Result<Attended> attend(Database& database, const std::string& server, Opening opening,
                        Recorder::ToJson to_json) {
    const auto name = storable(server, kLongestName);
    Attended attended;
    const auto hold = [&]() -> Result<void> {
        auto presence = database.attend(name);
        if (presence) {
            attended.presence = std::move(*presence);
        }
        return presence ? Result<void>() : Result<void>(fail(presence.error()));
    };
    if (opening == Opening::again) {
        const auto held = hold();
        return held ? Result<Attended>(std::move(attended)) : Result<Attended>(fail(held.error()));
    }
    const auto lost = closeIfDead(database, name, to_json, hold);
    if (!lost) {
        return fail(lost.error());
    }
    attended.lost = *lost;
    return attended;
}

Result<Dropped> closeLostOfOthers(Database& database, const std::string& own,
                                  Recorder::ToJson to_json) {
    const auto servers = database.query(
        "SELECT server FROM history WHERE ended = 0 AND server <> $1 UNION "
        "SELECT server FROM backlog WHERE server <> $1",
        std::array<Cell, 1>{storable(own, kLongestName)});
    if (!servers) {
        return fail(servers.error());
    }
    Dropped lost;
    for (const auto& row : *servers) {
        const auto closed =
            closeIfDead(database, row.text(0), to_json, [] { return Result<void>(); });
        if (!closed) {
            return fail(closed.error());
        }
        lost += *closed;
    }
    return lost;
}

}  // namespace metier::records
