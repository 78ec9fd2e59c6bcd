#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "metier/records/execution_row.hpp"

namespace metier::records {

/// Table of the schema that has a member's column: the executions themselves, or one of the two
/// that keep each repeated text once.
/// `kinds` has a row for each combination of server, controller, skill, device, user, state and
/// reason; `notes` has the texts of reasons.
enum class Table : std::uint8_t { executions, kinds, notes };

/// Kind of a text; it decides after how many bytes the text is cut: name 300, key 2000, json
/// 1,000,000.
/// A text is cut between two characters of UTF-8. JSON that was cut can no longer be parsed and is
/// shown as a text.
enum class Form : std::uint8_t { name, key, json };

/// Description of a member of ExecutionRow or Transition. JSON, SQL, the limits of texts and the
/// memory that a record takes all use these descriptions.
/// Texts are literals of this file and valid for ever.
struct Member {
    /// Name in JSON.
    std::string_view name;
    /// Name in SQL.
    std::string_view column = name;
    /// Table that has the column.
    Table table = Table::executions;
    /// Kind of the text; for others without a meaning.
    Form form = Form::name;
    /// Whether it changes after the begin, in the table of executions.
    bool changes = false;
};

/// Calls visit(const Member&, T& member) for each member, in their order. T is std::string,
/// UtcTime, std::int64_t (the number in the store) or std::uint64_t, const if `execution` is.
template <typename E, typename Visit>
requires std::same_as<std::remove_const_t<E>, ExecutionRow>
/// The order is that of the members in JSON. A new member needs a column in the schema.
///
///     visitMembers(row, [&](const Member& member, const auto& value) {
///         object[std::string(member.name)] = value;
///     });
/// \param visit takes every type above, as a generic lambda does; may keep the Member's texts
/// Threads: any; calls `visit` on the calling one.
void visitMembers(E& execution, Visit visit) {
    using enum Table;
    const auto column = [](std::string_view name) { return Member{.name = name}; };
    const auto kind = [](std::string_view name) { return Member{.name = name, .table = kinds}; };
    visit(column("number"), execution.number);
    visit(Member{.name = "id", .form = Form::key}, execution.id);
    visit(kind("server"), execution.server);
    visit(kind("server_name"), execution.server_name);
    visit(kind("skill"), execution.skill);
    visit(kind("controller"), execution.controller);
    visit(kind("device"), execution.device);
    visit(Member{.name = "parent", .form = Form::key}, execution.parent);
    visit(column("parent_server"), execution.parent_server);
    visit(column("session"), execution.session);
    visit(column("client_name"), execution.client_name);
    visit(Member{.name = "user", .column = "user_name", .table = kinds}, execution.user);
    visit(column("thumbprint"), execution.thumbprint);
    visit(Member{.name = "parameters", .form = Form::json}, execution.parameters);
    visit(Member{.name = "check", .column = "check_report", .form = Form::json}, execution.check);
    visit(column("started"), execution.started);
    visit(Member{.name = "ended", .changes = true}, execution.ended);
    visit(kind("state"), execution.state);
    visit(kind("reason"), execution.reason);
    visit(Member{.name = "reason_text", .table = notes, .form = Form::key}, execution.reason_text);
    visit(Member{.name = "result", .form = Form::json, .changes = true}, execution.result);
    visit(Member{.name = "missed_cycles", .changes = true}, execution.missed_cycles);
}

/// The same for a transition.
template <typename T, typename Visit>
requires std::same_as<std::remove_const_t<T>, Transition>
/// A transition has no columns of its own: an event is stored as the list of its members, so their
/// order and number are the format of stored events. A changed list makes older ones unreadable.
/// Threads of all: any.
void visitMembers(T& transition, Visit visit) {
    visit(Member{.name = "time"}, transition.time);
    visit(Member{.name = "from"}, transition.from);
    visit(Member{.name = "to"}, transition.to);
    visit(Member{.name = "sub_state"}, transition.sub_state);
    visit(Member{.name = "step"}, transition.step);
    visit(Member{.name = "reason"}, transition.reason);
    visit(Member{.name = "reason_text", .form = Form::key}, transition.reason_text);
}

/// The same for an intermediate result, and for an outcome.
template <typename T, typename Visit>
requires std::same_as<std::remove_const_t<T>, Intermediate>
/// The same for an intermediate result.
/// `value` is JSON already: a writer of JSON must not quote it again.
void visitMembers(T& intermediate, Visit visit) {
    visit(Member{.name = "time"}, intermediate.time);
    visit(Member{.name = "value", .form = Form::json}, intermediate.value);
}

template <typename T, typename Visit>
requires std::same_as<std::remove_const_t<T>, Outcome>
/// The same for an outcome.
void visitMembers(T& outcome, Visit visit) {
    visit(Member{.name = "time"}, outcome.time);
    visit(Member{.name = "state"}, outcome.state);
    visit(Member{.name = "reason"}, outcome.reason);
    visit(Member{.name = "reason_text", .form = Form::key}, outcome.reason_text);
    visit(Member{.name = "result", .form = Form::json}, outcome.result);
    visit(Member{.name = "missed_cycles"}, outcome.missed_cycles);
}

}  // namespace metier::records
