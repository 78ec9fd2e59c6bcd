#include "search.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>

#include "parts.hpp"
#include "text.hpp"

namespace metier::records {
namespace {

/// Subqueries in one statement; SQLite takes 500.
constexpr std::size_t kAtOnce = 100;

/// The newest executions that meet `condition` within the bounds, which are the first parameters.
std::string newest(const std::string& condition) {
    return fmt::format(
        "SELECT started, number FROM executions WHERE {} AND started >= $1 AND "
        "(started, number) < ($2, $3) ORDER BY started DESC, number DESC LIMIT $4",
        condition);
}

}  // namespace

Search::Search(Database& database, const Filter& filter, const Page& page)
    : database_(database),
      filter_(filter),
      count_(std::clamp<std::size_t>(page.count, 1, kLargestPage) + 1),
      before_(page.before) {}

bool Search::namesKinds() const {
    Values none;
    return namesFit(filter_, none) != "TRUE";
}

Values Search::bounds() const {
    return Values({lower_, upper_.first, upper_.second, static_cast<std::int64_t>(count_)});
}

Result<std::vector<std::int64_t>> Search::run() {
    METIER_ASSIGN(const auto bounded, findBounds());
    const auto done = !bounded                  ? Result<void>()
                      : !filter_.parent.empty() ? takeChildren()
                      : !filter_.text.empty()   ? takeText()
                      : namesKinds()            ? takeKinds()
                                                : take(newest("TRUE"), bounds());
    return done.map([this] {
        Numbers numbers;
        std::transform(found_.begin(), found_.end(), std::back_inserter(numbers),
                       [](const Found& found) { return found.second; });
        return numbers;
    });
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
    METIER_ASSIGN(const auto started,
                  database_.numbers("SELECT started FROM executions WHERE number = $1", {before_}));
    if (!started.empty()) {
        upper_ = std::min(upper_, Found{started.front(), before_});
    }
    return !started.empty();
}

Result<void> Search::take(const std::string& sql, const Values& values) {
    METIER_ASSIGN(const auto rows, database_.query(sql, values.all()));
    for (const auto& row : rows) {
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

Result<Search::Numbers> Search::kinds(const std::string& condition, const Values& values) {
    return database_.numbers("SELECT kind FROM kinds WHERE " + condition, values.all());
}

Result<void> Search::takeKinds() {
    Values values;
    const auto condition = namesFit(filter_, values);
    METIER_ASSIGN(const auto fitting, kinds(condition, values));
    return takeOfEach("kind", fitting, "TRUE");
}

/// The newest of each value of an indexed column.
Result<void> Search::takeOfEach(const std::string& column, const Numbers& numbers,
                                const std::string& condition) {
    for (std::size_t i = 0; i < numbers.size(); i += kAtOnce) {
        const auto last = std::min(numbers.size(), i + kAtOnce);
        std::vector<std::string> each;
        for (std::size_t j = i; j < last; ++j) {
            each.push_back(fmt::format(
                "SELECT * FROM ({}) AS t{}",
                newest(fmt::format("{} = {} AND {}", column, numbers[j], condition)), j));
        }
        METIER_TRY(take(fmt::format("{}", fmt::join(each, " UNION ALL ")), bounds()));
    }
    return {};
}

Result<void> Search::takeText() {
    Values values;
    const auto condition = namesFit(filter_, values);
    METIER_ASSIGN(const auto fitting, kinds(condition, values));
    if (fitting.empty()) {
        return {};
    }
    // The plus keeps a database from starting with the kinds.
    const auto of_kinds =
        condition == "TRUE" ? condition : fmt::format("+kind IN ({})", fmt::join(fitting, ", "));
    const auto with_text = condition + " AND " + namesContain(filter_.text, values);
    auto bounded = bounds();
    const auto of_id = fmt::format("id = {} AND {}", bounded.add(storable(filter_.text)), of_kinds);
    METIER_ASSIGN(const auto named, kinds(with_text, values));
    METIER_TRY(takeOfEach("kind", named, "TRUE"));
    METIER_TRY(takeNotes(of_kinds));
    return take(newest(of_id), bounded);
}

Result<void> Search::takeNotes(const std::string& of_kinds) {
    const auto notes = [this](Values& values) {
        return "SELECT note FROM notes WHERE note <> 0 AND " + reasonContains(filter_.text, values);
    };
    Values values;
    const auto some = fmt::format("{} LIMIT {}", notes(values), kAtOnce + 1);
    METIER_ASSIGN(const auto fitting, database_.numbers(some, values.all()));
    if (fitting.size() <= kAtOnce) {
        return takeOfEach("note", fitting, "note <> 0 AND " + of_kinds);
    }
    // If many fit, the newest executions that have a note soon show enough.
    auto bounded = bounds();
    const auto all = notes(bounded);
    return take(newest(fmt::format("note <> 0 AND +note IN ({}) AND {}", all, of_kinds)), bounded);
}

/// A parent has few.
Result<void> Search::takeChildren() {
    auto values = bounds();
    const auto parent = values.add(storable(filter_.parent));
    return take(newest(fmt::format("parent = {} AND parent <> '' AND number IN (SELECT number FROM "
                                   "history WHERE {})",
                                   parent, fits(filter_, values))),
                values);
}

}  // namespace metier::records
