#include "rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <utility>

#include "metier/records/members.hpp"
#include "parts.hpp"

namespace metier::records {

namespace {

bool isOfKind(const Member& member) {
    return member.table == Table::kinds;
}
bool isInserted(const Member& member) {
    return member.table == Table::executions && member.name != "number";
}
bool isUpdated(const Member& member) {
    return isInserted(member) && member.changes;
}
bool isAny(const Member& /*member*/) {
    return true;
}

using Wanted = bool (*)(const Member&);

/// Appends the columns of the members that are wanted.
std::vector<std::string> columnsOf(Wanted wanted, std::vector<std::string> columns = {}) {
    const ExecutionRow execution;
    visitMembers(execution, [&](const Member& member, const auto& /*value*/) {
        if (wanted(member)) {
            columns.emplace_back(member.column);
        }
    });
    return columns;
}

/// "a, b"
std::string listOf(const std::vector<std::string>& columns) {
    return fmt::format("{}", fmt::join(columns, ", "));
}

/// With the parameter of each: "$1, $2" for "${1}", "a = $1, b = $2" for "{0} = ${1}".
std::string parametersOf(const std::vector<std::string>& columns, std::string_view form,
                         std::string_view between) {
    std::vector<std::string> all;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        all.push_back(fmt::format(fmt::runtime(form), columns[i], i + 1));
    }
    return fmt::format("{}", fmt::join(all, between));
}

constexpr std::string_view kParameter = "${1}";
constexpr std::string_view kEquality = "{0} = ${1}";

void read(const Row& row, std::size_t column, std::string& text) {
    text = row.text(column);
}
void read(const Row& row, std::size_t column, UtcTime& time) {
    time = fromMicroseconds(row.integer(column));
}
void read(const Row& row, std::size_t column, std::int64_t& number) {
    number = row.integer(column);
}
void read(const Row& row, std::size_t column, std::uint64_t& count) {
    count = static_cast<std::uint64_t>(row.integer(column));
}

Argument argumentOf(const std::string& text) {
    return std::string_view(text);
}
Argument argumentOf(UtcTime time) {
    return toMicroseconds(time);
}
Argument argumentOf(std::int64_t number) {
    return number;
}
Argument argumentOf(std::uint64_t count) {
    return static_cast<std::int64_t>(count);
}

/// Appends the values of the members that are wanted.
std::vector<Argument> valuesOf(const ExecutionRow& execution, Wanted wanted,
                               std::vector<Argument> values = {}) {
    visitMembers(execution, [&](const Member& member, const auto& value) {
        if (wanted(member)) {
            values.push_back(argumentOf(value));
        }
    });
    return values;
}

}  // namespace

Result<std::vector<ExecutionRow>> readExecutions(Database& database, std::string_view condition,
                                                 const std::vector<Cell>& values) {
    static const auto kSelect =
        fmt::format("SELECT {} FROM history WHERE ", listOf(columnsOf(isAny)));
    METIER_ASSIGN(const auto rows, database.query(kSelect + std::string(condition), values));
    std::vector<ExecutionRow> result(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        std::size_t column = 0;
        visitMembers(result[i], [&](const Member& /*member*/, auto& value) {
            read(rows[i], column++, value);
        });
    }
    return result;
}

Result<void> RowWriter::takeRevisions(std::int64_t count) {
    const auto latest = database_.number(
        "UPDATE metier_records SET value = value + $1 WHERE name = 'revision' RETURNING value",
        {count});
    revision_ = latest.value_or(0) - count;
    return latest.map([](std::int64_t /*latest*/) {});
}

Result<std::int64_t> RowWriter::insertOrFind(std::string_view insert, std::string_view find,
                                             std::span<const Argument> values) {
    for (const auto sql : {find, insert, find}) {
        METIER_ASSIGN(const auto rows, database_.execute(sql, values));
        if (!rows.empty()) {
            return rows.front().integer(0);
        }
    }
    return fail(Errc::internal, database_.name() + ": a row that was inserted is not there");
}

Result<std::int64_t> RowWriter::kindOf(const ExecutionRow& execution) {
    const auto values = valuesOf(execution, isOfKind);
    std::string key;
    for (const auto& value : values) {
        key.append(std::get<std::string_view>(value)).push_back('\0');  // no stored text has one
    }
    if (const auto known = kinds_.find(key); known != kinds_.end()) {
        return known->second;
    }
    static const auto kColumns = columnsOf(isOfKind);
    static const auto kInsert =
        fmt::format("INSERT INTO kinds ({}) VALUES ({}) ON CONFLICT DO NOTHING RETURNING kind",
                    listOf(kColumns), parametersOf(kColumns, kParameter, ", "));
    static const auto kFind =
        fmt::format("SELECT kind FROM kinds WHERE {}", parametersOf(kColumns, kEquality, " AND "));
    auto kind = insertOrFind(kInsert, kFind, values);
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

Result<void> RowWriter::save(ExecutionRow& execution) {
    METIER_ASSIGN(const auto kind, kindOf(execution));
    METIER_ASSIGN(const auto note, noteOf(execution.reason_text));
    ++revision_;
    return execution.number == 0 ? insert(execution, kind, note) : update(execution, kind, note);
}

Result<void> RowWriter::insert(ExecutionRow& execution, std::int64_t kind, std::int64_t note) {
    static const auto kColumns = columnsOf(isInserted, {"kind", "note", "revision"});
    static const auto kInsert =
        fmt::format("INSERT INTO executions ({}) VALUES ({}) RETURNING number", listOf(kColumns),
                    parametersOf(kColumns, kParameter, ", "));
    return database_.execute(kInsert, valuesOf(execution, isInserted, {kind, note, revision_}))
        .map([&](const Rows& rows) { execution.number = rows.front().integer(0); });
}

Result<void> RowWriter::update(const ExecutionRow& execution, std::int64_t kind,
                               std::int64_t note) {
    static const auto kColumns = columnsOf(isUpdated, {"kind", "note", "revision"});
    static const auto kUpdate =
        fmt::format("UPDATE executions SET {} WHERE number = ${}",
                    parametersOf(kColumns, kEquality, ", "), kColumns.size() + 1);
    auto values = valuesOf(execution, isUpdated, {kind, note, revision_});
    values.emplace_back(execution.number);
    return database_.execute(kUpdate, values).map([](const Rows& /*none*/) {});
}

Result<std::int64_t> RowWriter::numberOf(const ExecutionRow& e) {
    return database_.number(
        "SELECT number FROM history WHERE id = $1 AND started = $2 AND server = $3 AND skill = $4 "
        "AND controller = $5",
        {e.id, toMicroseconds(e.started), e.server, e.skill, e.controller});
}

Result<void> RowWriter::addPart(std::int64_t part, const std::string& events,
                                const Bytes& samples) {
    return database_
        .execute(
            "INSERT INTO parts (part, events, samples) VALUES ($1, $2, $3) ON CONFLICT DO NOTHING",
            std::array<Argument, 3>{part, events, samples})
        .map([](const Rows& /*none*/) {});
}

}  // namespace metier::records
