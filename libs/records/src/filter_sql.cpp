#include "filter_sql.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "metier/records/members.hpp"
#include "parts.hpp"
#include "text.hpp"

namespace metier::records {
namespace {

/// For LIKE ... ESCAPE '\': any text with `part` in it.
std::string containing(std::string_view part) {
    std::string pattern = "%";
    for (const char c : part) {
        if (c == '%' || c == '_' || c == '\\') {
            pattern += '\\';
        }
        pattern += c;
    }
    return storable(pattern + "%");
}

std::string contains(std::string_view column, std::string_view text, Values& values) {
    return fmt::format("lower({}) LIKE lower({}) ESCAPE '\\'", column,
                       values.add(containing(text)));
}

/// All names that a text is looked for in: "server || ' ' || skill".
std::string allNames() {
    std::vector<std::string_view> columns;
    const ExecutionRow execution;
    visitMembers(execution, [&columns](const Member& member, const auto& /*value*/) {
        if (member.table == Table::kinds) {
            columns.push_back(member.column);
        }
    });
    return fmt::format("{}", fmt::join(columns, " || ' ' || "));
}

/// Conditions that all have to hold.
class Conjunction {
public:
    void add(std::string condition) { all_.push_back(std::move(condition)); }
    void addEqual(std::string_view column, const std::string& value, Values& values) {
        if (!value.empty()) {
            add(fmt::format("{} = {}", column, values.add(storable(value))));
        }
    }
    std::string sql() const {
        return all_.empty() ? "TRUE" : fmt::format("({})", fmt::join(all_, " AND "));
    }

private:
    std::vector<std::string> all_;
};

}  // namespace

std::string Values::add(Cell value) {
    all_.push_back(std::move(value));
    return fmt::format("${}", all_.size());
}

std::string namesFit(const Filter& filter, Values& values) {
    Conjunction all;
    if (!filter.server.empty()) {
        all.add(fmt::format("(server = {0} OR server_name = {0})",
                            values.add(storable(filter.server))));
    }
    all.addEqual("skill", filter.skill, values);
    all.addEqual("state", filter.state, values);
    all.addEqual("reason", filter.reason, values);
    all.addEqual("user_name", filter.user, values);
    return all.sql();
}

std::string namesContain(std::string_view text, Values& values) {
    static const auto kNames = allNames();
    return contains(kNames, text, values);
}

std::string reasonContains(std::string_view text, Values& values) {
    return contains("reason_text", text, values);
}

std::string fits(const Filter& filter, Values& values) {
    Conjunction all;
    all.add(namesFit(filter, values));
    if (!filter.parent.empty()) {
        // The index has those alone that have a parent.
        all.add(fmt::format("parent = {} AND parent <> ''", values.add(storable(filter.parent))));
    }
    if (filter.from) {
        all.add("started >= " + values.add(toMicroseconds(*filter.from)));
    }
    if (filter.until) {
        all.add("started < " + values.add(toMicroseconds(*filter.until)));
    }
    if (!filter.text.empty()) {
        all.add(fmt::format("({} OR {} OR id = {})", namesContain(filter.text, values),
                            reasonContains(filter.text, values),
                            values.add(storable(filter.text))));
    }
    return all.sql();
}

}  // namespace metier::records
