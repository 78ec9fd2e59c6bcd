#include "schema.hpp"

#include <fmt/format.h>

namespace metier::records {
namespace {

constexpr std::string_view kMarker = "metier_records";

// Times are microseconds since 1970-01-01 UTC. Nothing is ever NULL: '' and 0 mean none.
//
// What many executions have in common is a row of `kinds`, what a reason said a row of `notes`:
// a filter looks for those that fit, which are few, and then takes the newest of each from an
// index; where many notes fit, it goes through executions that have one, newest first. `parts`
// holds what came while an execution was under way, in the order it was written: its key is number
// * 1048576 + count. `backlog` holds what a recorder was told faster than it made rows of it, each
// recorder a life of its own, with the executions that were under way before the oldest.
constexpr std::string_view kTables = R"(
CREATE TABLE metier_records (name TEXT PRIMARY KEY, value BIGINT NOT NULL);
INSERT INTO metier_records VALUES ('schema_version', {version}), ('revision', 0);
CREATE TABLE kinds (kind {number_key},
    server TEXT NOT NULL, server_name TEXT NOT NULL, controller TEXT NOT NULL, skill TEXT NOT NULL,
    device TEXT NOT NULL, user_name TEXT NOT NULL, state TEXT NOT NULL, reason TEXT NOT NULL,
    UNIQUE (server, server_name, controller, skill, device, user_name, state, reason));
CREATE TABLE notes (note {number_key}, reason_text TEXT NOT NULL UNIQUE);
INSERT INTO notes VALUES (0, '');
CREATE TABLE executions (number {number_key},
    kind BIGINT NOT NULL, note BIGINT NOT NULL, started BIGINT NOT NULL, ended BIGINT NOT NULL,
    revision BIGINT NOT NULL, id TEXT NOT NULL, parent TEXT NOT NULL, parent_server TEXT NOT NULL,
    session TEXT NOT NULL, client_name TEXT NOT NULL, thumbprint TEXT NOT NULL,
    missed_cycles BIGINT NOT NULL, parameters TEXT NOT NULL, result TEXT NOT NULL,
    check_report TEXT NOT NULL);
CREATE INDEX executions_by_start ON executions (started, number);
CREATE INDEX executions_by_kind ON executions (kind, started, number);
CREATE INDEX executions_by_note ON executions (note, started, number) WHERE note <> 0;
CREATE INDEX executions_noted ON executions (started, number, note, kind) WHERE note <> 0;
CREATE INDEX executions_by_id ON executions (id);
CREATE INDEX executions_by_parent ON executions (parent) WHERE parent <> '';
CREATE INDEX executions_by_revision ON executions (revision);
CREATE INDEX executions_under_way ON executions (number) WHERE ended = 0;
CREATE TABLE parts (part BIGINT PRIMARY KEY, events TEXT NOT NULL, samples {blob} NOT NULL);
CREATE VIEW history AS SELECT e.number, e.id, k.server, k.server_name, k.controller, k.skill,
    k.device, k.user_name, k.state, k.reason, n.reason_text, e.started, e.ended, e.parent,
    e.parent_server, e.session, e.client_name, e.thumbprint, e.missed_cycles, e.parameters,
    e.result, e.check_report, e.revision
    FROM executions e JOIN kinds k ON k.kind = e.kind JOIN notes n ON n.note = e.note;
)";

// Later than the others: stores of the same version may lack it until somebody writes.
constexpr std::string_view kBacklogName = "backlog";
constexpr std::string_view kBacklog = R"(
CREATE TABLE backlog (life BIGINT NOT NULL, number BIGINT NOT NULL, server TEXT NOT NULL,
    under_way TEXT NOT NULL, content {blob} NOT NULL, PRIMARY KEY (life, number));
)";

Result<void> make(Database& database, std::string_view marker, std::string_view tables) {
    return inTransaction(database, [&]() -> Result<void> {
        // Another server may have made them while this one waited for its transaction.
        const auto there = database.hasTable(marker);
        if (!there) {
            return fail(there.error());
        }
        const auto& dialect = database.dialect();
        return *there ? Result<void>()
                      : database.script(fmt::format(fmt::runtime(tables),
                                                    fmt::arg("version", kSchemaVersion),
                                                    fmt::arg("number_key", dialect.number_key),
                                                    fmt::arg("blob", dialect.blob)));
    });
}

/// What this version has and the one that made the store may not have had.
Result<void> complete(Database& database) {
    const auto there = database.hasTable(kBacklogName);
    if (!there) {
        return fail(there.error());
    }
    return *there ? Result<void>() : make(database, kBacklogName, kBacklog);
}

Result<void> checkVersion(Database& database) {
    const auto rows =
        database.query("SELECT value FROM metier_records WHERE name = 'schema_version'", {});
    if (!rows) {
        return fail(rows.error());
    }
    const auto version = rows->empty() ? 0 : rows->front().integer(0);
    if (version == kSchemaVersion) {
        return {};
    }
    return fail(version > kSchemaVersion ? Errc::not_supported : Errc::invalid_argument,
                fmt::format("{}: records of schema version {}; this metier knows version {}",
                            database.name(), version, kSchemaVersion));
}

}  // namespace

Result<void> prepareSchema(Database& database, Store::Access access) {
    const auto marked = database.hasTable(kMarker);
    if (!marked) {
        return fail(marked.error());
    }
    if (!*marked) {
        const auto empty = database.isEmpty();
        if (!empty) {
            return fail(empty.error());
        }
        if (!*empty) {
            return fail(Errc::invalid_argument,
                        database.name() + " holds other tables than those of records");
        }
        if (access == Store::Access::read) {
            return fail(Errc::not_found, database.name() + ": there are no records");
        }
        if (auto made = make(database, kMarker, kTables); !made) {
            return made;
        }
    }
    auto known = checkVersion(database);
    return known && access == Store::Access::write ? complete(database) : known;
}

}  // namespace metier::records
