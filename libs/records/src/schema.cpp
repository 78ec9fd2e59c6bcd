#include "schema.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace metier::records {
namespace {

// Times are microseconds since 1970-01-01 UTC. Nothing is ever NULL: '' and 0 mean none.
//
// A row of `kinds` has what many executions have in common, a row of `notes` the text of a reason:
// a filter looks for those that fit, which are few, and then takes the newest of each from an
// index; where many notes fit, it goes through executions that have one, newest first. `parts`
// holds what came while an execution was under way, in the order it was written: its key is number
// * 1048576 + count.
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

Result<void> make(Database& database) {
    const auto& dialect = database.dialect();
    return database.script(fmt::format(fmt::runtime(kTables), fmt::arg("version", kSchemaVersion),
                                       fmt::arg("number_key", dialect.number_key),
                                       fmt::arg("blob", dialect.blob)));
}

Result<void> checkVersion(Database& database) {
    const auto version =
        database.number("SELECT value FROM metier_records WHERE name = 'schema_version'");
    if (!version || *version == kSchemaVersion) {
        return version.map([](auto /*version*/) {});
    }
    return fail(*version > kSchemaVersion ? Errc::not_supported : Errc::invalid_argument,
                fmt::format("{}: records of schema version {}; this metier knows version {}",
                            database.name(), *version, kSchemaVersion));
}

/// Errors: not_found (no tables), invalid_argument (those of others), not_supported.
Result<void> check(Database& database) {
    METIER_ASSIGN(const auto tables, database.query(database.dialect().tables));
    if (tables.empty()) {
        return fail(Errc::not_found, database.name() + ": there are no records");
    }
    const bool known = std::any_of(tables.begin(), tables.end(),
                                   [](const Row& row) { return row.text(0) == "metier_records"; });
    return known ? checkVersion(database)
                 : fail(Errc::invalid_argument,
                        database.name() + " holds other tables than those of records");
}

}  // namespace

Result<void> prepareSchema(Database& database, Store::Access access) {
    if (access == Store::Access::read) {
        return check(database);
    }
    return inTransaction(database, [&database]() -> Result<void> {
        auto known = check(database);
        if (!known && known.error().code == Errc::not_found) {
            return make(database);
        }
        // Versions that wrote floods as they came left them there until they had made rows.
        return known ? database.script("DROP TABLE IF EXISTS backlog") : known;
    });
}

}  // namespace metier::records
