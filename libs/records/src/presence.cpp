#include "presence.hpp"

#include <array>

#include "backlog.hpp"
#include "text.hpp"
#include "writer.hpp"

namespace metier::records {
namespace {

/// Within a transaction, so that the server does not begin meanwhile.
Result<void> closeIfDead(Database& database, const std::string& server, Recorder::ToJson to_json,
                         Dropped& lost) {
    const auto attended = database.isAttendedByOthers(server);
    if (!attended) {
        return fail(attended.error());
    }
    if (*attended) {
        return {};
    }
    const auto recovered = Backlog::recover(database, server, to_json);
    if (!recovered) {
        return fail(recovered.error());
    }
    lost += *recovered;
    return Writer::closeLost(database, server);
}

}  // namespace

Result<Dropped> attend(Database& database, const std::string& server, Opening opening,
                       Recorder::ToJson to_json) {
    const auto name = storable(server, kLongestName);
    Dropped lost;
    const auto done = inTransaction(database, [&]() -> Result<void> {
        auto closed =
            opening == Opening::first ? closeIfDead(database, name, to_json, lost) : Result<void>();
        return closed ? database.attend(name) : closed;
    });
    return done ? Result<Dropped>(lost) : Result<Dropped>(fail(done.error()));
}

Result<Dropped> closeLostOfOthers(Database& database, const std::string& own,
                                  Recorder::ToJson to_json) {
    Dropped lost;
    const auto done = inTransaction(database, [&]() -> Result<void> {
        const auto servers = database.query(
            "SELECT server FROM history WHERE ended = 0 AND server <> $1 UNION "
            "SELECT server FROM backlog WHERE server <> $1",
            std::array<Cell, 1>{storable(own, kLongestName)});
        if (!servers) {
            return fail(servers.error());
        }
        for (const auto& row : *servers) {
            if (auto closed = closeIfDead(database, row.text(0), to_json, lost); !closed) {
                return closed;
            }
        }
        return {};
    });
    return done ? Result<Dropped>(lost) : Result<Dropped>(fail(done.error()));
}

}  // namespace metier::records
