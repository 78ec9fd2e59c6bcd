#include "presence.hpp"

#include <array>

#include "text.hpp"
#include "writer.hpp"

namespace metier::records {
namespace {

/// Within a transaction, so that the server does not begin meanwhile.
Result<void> closeIfDead(Database& database, const std::string& server) {
    const auto attended = database.isAttendedByOthers(server);
    if (!attended) {
        return fail(attended.error());
    }
    return *attended ? Result<void>() : Writer::closeLost(database, server);
}

}  // namespace

Result<void> attend(Database& database, const std::string& server, Opening opening) {
    const auto name = storable(server, kLongestName);
    return inTransaction(database, [&]() -> Result<void> {
        auto closed = opening == Opening::first ? closeIfDead(database, name) : Result<void>();
        return closed ? database.attend(name) : closed;
    });
}

Result<void> closeLostOfOthers(Database& database, const std::string& own) {
    return inTransaction(database, [&]() -> Result<void> {
        const auto servers =
            database.query("SELECT DISTINCT server FROM history WHERE ended = 0 AND server <> $1",
                           std::array<Cell, 1>{storable(own, kLongestName)});
        if (!servers) {
            return fail(servers.error());
        }
        for (const auto& row : *servers) {
            if (auto closed = closeIfDead(database, row.text(0)); !closed) {
                return closed;
            }
        }
        return {};
    });
}

}  // namespace metier::records
