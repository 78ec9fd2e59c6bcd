#include "listing.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "parts.hpp"
#include "text.hpp"

namespace metier::records {
namespace {

/// Subqueries in one statement; SQLite takes 500.
constexpr std::size_t kAtOnce = 100;
/// All names that a text is looked for in.
constexpr std::string_view kNames =
    "server || ' ' || server_name || ' ' || controller || ' ' || skill || ' ' || device || ' ' || "
    "user_name || ' ' || state || ' ' || reason";

/// The notes with a text, which is the parameter of the number that is to be filled in.
constexpr std::string_view kNotes =
    "SELECT note FROM notes WHERE note <> 0 AND lower(reason_text) LIKE lower(${}) ESCAPE '\\'";

/// For LIKE ... ESCAPE '\': any text with `part` in it.
std::string containing(std::string_view part) {
    std::string pattern = "%";
    for (const char c : part) {
        if (c == '%' || c == '_' || c == '\\') {
            pattern += '\\';
        }
        pattern += c;
    }
    return pattern + "%";
}

Result<std::vector<std::int64_t>> numbers(const Result<Rows>& rows) {
    if (!rows) {
        return fail(rows.error());
    }
    std::vector<std::int64_t> values;
    for (const auto& row : *rows) {
        values.push_back(row.integer(0));
    }
    return values;
}

}  // namespace

Search::Search(Database& database, const Filter& filter, const Page& page)
    : database_(database),
      filter_(filter),
      count_(std::clamp<std::size_t>(page.count, 1, kLargestPage) + 1),
      before_(page.before) {}

bool Search::namesKinds() const {
    const std::array names{&filter_.server, &filter_.skill, &filter_.state, &filter_.reason,
                           &filter_.user};
    return std::any_of(names.begin(), names.end(), [](const auto* name) { return !name->empty(); });
}

Result<std::vector<std::int64_t>> Search::run() {
    const auto bounded = findBounds();
    if (!bounded) {
        return fail(bounded.error());
    }
    auto done = !*bounded                                          ? Result<void>()
                : !filter_.text.empty() || !filter_.parent.empty() ? takeText()
                : namesKinds()                                     ? takeKinds()
                                                                   : take(newest("TRUE"));
    if (!done) {
        return fail(done.error());
    }
    std::vector<std::int64_t> result;
    for (const auto& [started, number] : found_) {
        result.push_back(number);
    }
    return result;
}

/// False: nothing is between them.
Result<bool> Search::findBounds() {
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    upper_ = {filter_.until ? toMicroseconds(*filter_.until) : kMost, 0};
    lower_ =
        filter_.from ? toMicroseconds(*filter_.from) : std::numeric_limits<std::int64_t>::min();
    if (before_ == 0) {
        return true;
    }
    const auto rows = database_.query("SELECT started FROM executions WHERE number = $1",
                                      std::array<Cell, 1>{before_});
    if (!rows) {
        return fail(rows.error());
    }
    if (!rows->empty()) {
        upper_ = std::min(upper_, Found{rows->front().integer(0), before_});
    }
    return !rows->empty();
}

/// Executions within the bounds that meet `condition`.
std::string Search::newest(const std::string& condition) {
    return fmt::format(
        "SELECT started, number FROM executions WHERE {} AND started >= $1 AND "
        "(started, number) < ($2, $3) ORDER BY started DESC, number DESC LIMIT $4",
        condition);
}

Result<void> Search::take(const std::string& sql, std::vector<Cell> more) {
    std::vector<Cell> cells{lower_, upper_.first, upper_.second, static_cast<std::int64_t>(count_)};
    cells.insert(cells.end(), more.begin(), more.end());
    const auto rows = database_.query(sql, cells);
    if (!rows) {
        return fail(rows.error());
    }
    for (const auto& row : *rows) {
        found_.insert({row.integer(0), row.integer(1)});
    }
    while (found_.size() > count_) {
        found_.erase(std::prev(found_.end()));
    }
    if (found_.size() == count_) {
        lower_ = std::max(lower_, found_.rbegin()->first);
    }
    return {};
}

Result<std::vector<std::int64_t>> Search::kinds(bool with_text) {
    std::string sql = "SELECT kind FROM kinds WHERE TRUE";
    std::vector<Cell> cells;
    const auto add = [&](std::string_view condition, const std::string& value) {
        if (!value.empty()) {
            cells.emplace_back(storable(value));
            sql += fmt::format(" AND ({})", fmt::format(fmt::runtime(condition), cells.size()));
        }
    };
    add("server = ${0} OR server_name = ${0}", filter_.server);
    add("skill = ${0}", filter_.skill);
    add("state = ${0}", filter_.state);
    add("reason = ${0}", filter_.reason);
    add("user_name = ${0}", filter_.user);
    if (with_text) {
        add(fmt::format("lower({}) LIKE lower(${{0}}) ESCAPE '\\'", kNames),
            containing(filter_.text));
    }
    return numbers(database_.query(sql, cells));
}

/// Those with the text, up to one more than are asked for at once.
Result<std::vector<std::int64_t>> Search::notes() {
    return numbers(database_.query(
        fmt::format(fmt::runtime(kNotes), 1) + fmt::format(" LIMIT {}", kAtOnce + 1),
        std::array<Cell, 1>{storable(containing(filter_.text))}));
}

Result<void> Search::takeKinds() {
    const auto fitting = kinds(false);
    return fitting ? takeOfEach("kind", *fitting, "TRUE") : Result<void>(fail(fitting.error()));
}

/// The newest of each value of an indexed column.
Result<void> Search::takeOfEach(const std::string& column, const std::vector<std::int64_t>& values,
                                const std::string& condition) {
    for (std::size_t i = 0; i < values.size(); i += kAtOnce) {
        const auto last = std::min(values.size(), i + kAtOnce);
        std::vector<std::string> each;
        for (std::size_t j = i; j < last; ++j) {
            each.push_back(fmt::format(
                "SELECT * FROM ({}) AS t{}",
                newest(fmt::format("{} = {} AND {}", column, values[j], condition)), j));
        }
        if (auto taken = take(fmt::format("{}", fmt::join(each, " UNION ALL "))); !taken) {
            return taken;
        }
    }
    return {};
}

/// With a text or a parent.
Result<void> Search::takeText() {
    const auto fitting = kinds(false);
    if (!fitting) {
        return fail(fitting.error());
    }
    // The plus keeps a database from starting with the kinds.
    const auto of_kinds = namesKinds() ? fmt::format("+kind IN ({})", fmt::join(*fitting, ", "))
                                       : std::string("TRUE");
    if (fitting->empty()) {
        return {};
    }
    if (!filter_.parent.empty()) {
        return takeChildren(of_kinds);
    }
    const auto named = kinds(true);
    auto done = named ? takeOfEach("kind", *named, "TRUE") : Result<void>(fail(named.error()));
    done = done ? takeNotes(of_kinds) : done;
    return done ? take(newest("id = $5 AND " + of_kinds), {storable(filter_.text)}) : done;
}

Result<void> Search::takeNotes(const std::string& of_kinds) {
    const auto fitting = notes();
    if (!fitting) {
        return fail(fitting.error());
    }
    if (fitting->size() <= kAtOnce) {
        return takeOfEach("note", *fitting, "note <> 0 AND " + of_kinds);
    }
    // Where many fit, the newest executions that have a note soon show enough.
    const auto all = fmt::format(fmt::runtime(kNotes), 5);
    return take(newest(fmt::format("note <> 0 AND +note IN ({}) AND {}", all, of_kinds)),
                {storable(containing(filter_.text))});
}

/// Of one parent there are few.
Result<void> Search::takeChildren(const std::string& of_kinds) {
    const auto children = fmt::format("parent = $5 AND parent <> '' AND {}", of_kinds);
    if (filter_.text.empty()) {
        return take(newest(children), {storable(filter_.parent)});
    }
    return take(
        newest(fmt::format("{} AND (id = $6 OR number IN (SELECT number FROM history WHERE "
                           "parent = $5 AND lower({} || ' ' || reason_text) LIKE lower($7) "
                           "ESCAPE '\\'))",
                           children, kNames)),
        {storable(filter_.parent), storable(filter_.text), storable(containing(filter_.text))});
}

}  // namespace metier::records
