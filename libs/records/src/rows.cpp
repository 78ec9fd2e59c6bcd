#include "rows.hpp"

#include <array>

#include "parts.hpp"

namespace metier::records {

const std::string_view kExecutionColumns =
    "number, id, server, server_name, controller, skill, device, user_name, state, reason, "
    "reason_text, started, ended, parent, parent_server, session, client_name, thumbprint, "
    "missed_cycles, parameters, result, check_report, revision";

Execution toExecution(const Row& row) {
    Execution e;
    e.number = row.integer(0);
    const std::array texts{&e.id,     &e.server, &e.server_name, &e.controller, &e.skill,
                           &e.device, &e.user,   &e.state,       &e.reason,     &e.reason_text};
    for (std::size_t i = 0; i < texts.size(); ++i) {
        *texts.at(i) = row.text(i + 1);
    }
    e.started = fromMicroseconds(row.integer(11));
    e.ended = fromMicroseconds(row.integer(12));
    const std::array more{&e.parent, &e.parent_server, &e.session, &e.client_name, &e.thumbprint};
    for (std::size_t i = 0; i < more.size(); ++i) {
        *more.at(i) = row.text(i + 13);
    }
    e.missed_cycles = static_cast<std::uint64_t>(row.integer(18));
    e.parameters = row.text(19);
    e.result = row.text(20);
    e.check = row.text(21);
    return e;
}

Result<void> RowWriter::takeRevisions(std::int64_t count) {
    const auto rows = database_.query(
        "UPDATE metier_records SET value = value + $1 WHERE name = 'revision' RETURNING value",
        std::array<Cell, 1>{count});
    if (!rows) {
        return fail(rows.error());
    }
    if (rows->empty()) {
        return fail(Errc::invalid_argument, database_.name() + ": the revision is missing");
    }
    revision_ = rows->front().integer(0) - count;
    return {};
}

Result<std::int64_t> RowWriter::insertOrFind(std::string_view insert, std::string_view find,
                                             std::span<const Argument> values) {
    for (const auto sql : {find, insert, find}) {
        const auto rows = database_.execute(sql, values);
        if (!rows) {
            return fail(rows.error());
        }
        if (!rows->empty()) {
            return rows->front().integer(0);
        }
    }
    return fail(Errc::internal, database_.name() + ": a row that was inserted is not there");
}

Result<std::int64_t> RowWriter::kindOf(const Execution& e) {
    const std::array<const std::string*, 8> texts{&e.server, &e.server_name, &e.controller,
                                                  &e.skill,  &e.device,      &e.user,
                                                  &e.state,  &e.reason};
    std::string key;
    for (const auto* text : texts) {
        key.append(*text).push_back('\0');  // no stored text has one
    }
    if (const auto known = kinds_.find(key); known != kinds_.end()) {
        return known->second;
    }
    std::vector<Argument> values;
    for (const auto* text : texts) {
        values.emplace_back(std::string_view(*text));
    }
    const auto kind = insertOrFind(
        "INSERT INTO kinds (server, server_name, controller, skill, device, user_name, state, "
        "reason) VALUES ($1, $2, $3, $4, $5, $6, $7, $8) ON CONFLICT DO NOTHING RETURNING kind",
        "SELECT kind FROM kinds WHERE server = $1 AND server_name = $2 AND controller = $3 AND "
        "skill = $4 AND device = $5 AND user_name = $6 AND state = $7 AND reason = $8",
        values);
    if (kind) {
        kinds_.emplace(std::move(key), *kind);
    }
    return kind;
}

/// Notes are removed with the last execution that has them, so they are looked for each time.
Result<std::int64_t> RowWriter::noteOf(const std::string& text) {
    if (text.empty()) {
        return 0;
    }
    return insertOrFind(
        "INSERT INTO notes (reason_text) VALUES ($1) ON CONFLICT DO NOTHING RETURNING note",
        "SELECT note FROM notes WHERE reason_text = $1", std::array<Argument, 1>{text});
}

Result<void> RowWriter::save(Execution& execution) {
    const auto kind = kindOf(execution);
    if (!kind) {
        return fail(kind.error());
    }
    const auto note = noteOf(execution.reason_text);
    if (!note) {
        return fail(note.error());
    }
    ++revision_;
    return execution.number == 0 ? insert(execution, *kind, *note)
                                 : update(execution, *kind, *note);
}

Result<void> RowWriter::insert(Execution& e, std::int64_t kind, std::int64_t note) {
    const std::array<Argument, 15> values{kind,
                                          note,
                                          toMicroseconds(e.started),
                                          toMicroseconds(e.ended),
                                          revision_,
                                          e.id,
                                          e.parent,
                                          e.parent_server,
                                          e.session,
                                          e.client_name,
                                          e.thumbprint,
                                          static_cast<std::int64_t>(e.missed_cycles),
                                          e.parameters,
                                          e.result,
                                          e.check};
    const auto number = database_.insert(
        "INSERT INTO executions (kind, note, started, ended, revision, id, parent, parent_server, "
        "session, client_name, thumbprint, missed_cycles, parameters, result, check_report) VALUES "
        "($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15)",
        "number", values);
    if (!number) {
        return fail(number.error());
    }
    e.number = *number;
    return {};
}

Result<void> RowWriter::update(const Execution& e, std::int64_t kind, std::int64_t note) {
    const std::array<Argument, 7> values{kind,
                                         note,
                                         toMicroseconds(e.ended),
                                         revision_,
                                         static_cast<std::int64_t>(e.missed_cycles),
                                         e.result,
                                         e.number};
    const auto rows = database_.execute(
        "UPDATE executions SET kind = $1, note = $2, ended = $3, revision = $4, "
        "missed_cycles = $5, result = $6 WHERE number = $7",
        values);
    return rows ? Result<void>() : Result<void>(fail(rows.error()));
}

Result<std::int64_t> RowWriter::numberOf(const Execution& e) {
    const auto rows = database_.query(
        "SELECT number FROM history WHERE id = $1 AND started = $2 AND server = $3 AND skill = $4 "
        "AND controller = $5",
        std::array<Cell, 5>{e.id, toMicroseconds(e.started), e.server, e.skill, e.controller});
    if (!rows) {
        return fail(rows.error());
    }
    return rows->empty() ? 0 : rows->front().integer(0);
}

Result<void> RowWriter::addPart(std::int64_t part, const std::string& events,
                                const Bytes& samples) {
    const auto rows = database_.execute(
        "INSERT INTO parts (part, events, samples) VALUES ($1, $2, $3) ON CONFLICT DO NOTHING",
        std::array<Argument, 3>{part, events, samples});
    return rows ? Result<void>() : Result<void>(fail(rows.error()));
}

}  // namespace metier::records
