#include "records_view.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <concepts>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "live_values.hpp"
#include "metier/base/text.hpp"
#include "metier/records/json.hpp"
#include "metier/records/members.hpp"
#include "skill_shown.hpp"

namespace metier::dashboard {

using nlohmann::json;
using records::ExecutionRow;
using records::Member;
using records::Store;

namespace {

/// JSON of a record's text, with frames as lists; null if there is none.
json parsed(const std::string& text) {
    auto value = text.empty() ? json() : json::parse(text, nullptr, false);
    return value.is_discarded() ? json(text) : inLists(value);
}

json valueOf(const Member& member, const std::string& text) {
    return member.form == records::Form::json ? parsed(text) : json(text);
}
json valueOf(const Member& /*member*/, UtcTime time) {
    return time == UtcTime{} ? json() : json(secondsOf(time));
}
template <std::integral T>
json valueOf(const Member& /*member*/, T number) {
    return number;
}

/// An object with the members of a record.
template <typename Record>
json objectOf(const Record& record) {
    auto shown = json::object();
    records::visitMembers(record, [&shown](const Member& member, const auto& value) {
        shown[std::string(member.name)] = valueOf(member, value);
    });
    return shown;
}

json valuesOf(const records::SampleValues& values) {
    return rounded(std::vector<double>(values.values().begin(), values.values().end()));
}

json jsonOf(const records::PathSample& sample) {
    json shown{{"time", rounded(sample.time)}, {"q", valuesOf(sample.actual)}};
    if (!sample.commanded.empty()) {
        shown["c"] = valuesOf(sample.commanded);
    }
    if (!sample.force.empty()) {
        shown["f"] = valuesOf(sample.force);
    }
    return shown;
}

/// Path with as many samples as a page can draw, the first and the last among them.
json pathJson(const std::vector<records::PathSample>& path) {
    constexpr std::size_t kMost = 20'000;
    const auto kept = std::min(path.size(), kMost);
    auto list = json::array();
    for (std::size_t i = 0; i < kept; ++i) {
        list.push_back(jsonOf(path[thinned(i, kept, path.size())]));
    }
    return list;
}

/// Seconds since 1970 UTC.
Result<std::optional<UtcTime>> timeIn(const httplib::Request& request, const char* name) {
    const auto text = request.get_param_value(name);
    if (text.empty()) {
        return std::optional<UtcTime>();
    }
    constexpr double kLongest = 1e10;
    const auto seconds = numberIn<double>(text);
    if (!seconds || !std::isfinite(*seconds) || std::abs(*seconds) > kLongest) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: seconds since 1970 UTC expected", name));
    }
    return std::optional(
        UtcTime(std::chrono::round<UtcTime::duration>(std::chrono::duration<double>(*seconds))));
}

/// Nothing if it is not given.
Result<std::int64_t> wholeIn(const httplib::Request& request, const char* name,
                             std::pair<std::int64_t, std::int64_t> range, std::int64_t otherwise) {
    const auto text = request.get_param_value(name);
    if (text.empty()) {
        return otherwise;
    }
    const auto number = numberIn<std::int64_t>(text);
    if (!number || *number < range.first || *number > range.second) {
        return fail(Errc::invalid_argument, fmt::format("{}: a whole number from {} to {} expected",
                                                        name, range.first, range.second));
    }
    return *number;
}

}  // namespace

Result<std::pair<records::Filter, records::Page>> recordsQuery(const httplib::Request& request) {
    constexpr std::int64_t kMostRecords = 1'000;
    constexpr std::int64_t kUsual = 100;
    records::Filter filter;
    for (const auto& [name, part] : {std::pair{"server", &filter.server},
                                     {"skill", &filter.skill},
                                     {"state", &filter.state},
                                     {"reason", &filter.reason},
                                     {"user", &filter.user},
                                     {"text", &filter.text},
                                     {"parent", &filter.parent}}) {
        *part = request.get_param_value(name);
    }
    METIER_ASSIGN(filter.from, timeIn(request, "from"));
    METIER_ASSIGN(filter.until, timeIn(request, "to"));
    METIER_ASSIGN(const auto before,
                  wholeIn(request, "before", {0, std::numeric_limits<std::int64_t>::max()}, 0));
    METIER_ASSIGN(const auto count, wholeIn(request, "count", {1, kMostRecords}, kUsual));
    return std::pair{std::move(filter), records::Page{before, static_cast<std::uint32_t>(count)}};
}

RecordsView::RecordsView(std::string url, Board& board)
    : recorded_(!url.empty()),
      store_(std::move(url)),
      board_(board),
      thread_([this](const std::stop_token& stop) { work(stop); }) {}

json RecordsView::recordJson(const ExecutionRow& execution) const {
    const auto arm = board_.armOf(execution.server, execution.controller, execution.skill);
    auto shown = objectOf(execution);
    shown["arm"] = arm.empty() ? json() : json(arm);
    return shown;
}

Reply RecordsView::list(const httplib::Request& request) {
    METIER_ASSIGN(const auto query, recordsQuery(request));
    const auto listing =
        recorded_ ? store_.use([&](Store& store) { return store.list(query.first, query.second); })
                  : Result<records::Listing>(fail(Errc::not_found, "nothing is recorded"));
    if (!listing && listing.error().code != Errc::not_found) {
        return errorReply(listing.error());
    }
    auto list = json::array();
    for (const auto& execution : listing ? listing->executions : std::vector<ExecutionRow>()) {
        list.push_back(recordJson(execution));
    }
    return {200, {{"records", std::move(list)}, {"more", listing && listing->more}}};
}

Result<json> RecordsView::detailsOf(Store& store, std::int64_t number) const {
    METIER_ASSIGN(const auto details, records::detailsOf(store, number));
    auto shown = recordJson(details.execution);
    shown["transitions"] = json::array();
    for (const auto& transition : details.transitions) {
        shown["transitions"].push_back(objectOf(transition));
    }
    shown["path"] = pathJson(details.path);
    shown["children"] = json::array();
    for (const auto& child : details.children) {
        shown["children"].push_back(recordJson(child));
    }
    return shown;
}

Reply RecordsView::one(std::int64_t number) {
    if (!recorded_) {
        return fail(Errc::not_found, "nothing is recorded");
    }
    METIER_ASSIGN(auto shown, store_.use([&](Store& store) { return detailsOf(store, number); }));
    return {200, std::move(shown)};
}

void RecordsView::show(bool shown) {
    {
        const std::lock_guard lock(mutex_);
        shown_ = shown;
    }
    changed_.notify_all();
}

void RecordsView::look(std::optional<std::int64_t>& revision) {
    const auto changes = store_.use([&](Store& store) -> Result<records::Changes> {
        return revision ? store.changes(*revision)
                        : store.latestRevision().map([](std::int64_t latest) {
                              return records::Changes{{}, latest};
                          });
    });
    if (!changes) {
        return;  // looked for again next time
    }
    revision = changes->revision;
    for (const auto& execution : changes->executions) {
        board_.noteRecord(execution.number);
    }
}

void RecordsView::work(const std::stop_token& stop) {
    constexpr std::chrono::milliseconds kBetween{500};
    std::optional<std::int64_t> revision;
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested() && recorded_) {
        if (!shown_) {
            revision.reset();
            changed_.wait(lock, stop, [this] { return shown_; });
            continue;
        }
        lock.unlock();
        look(revision);
        lock.lock();
        changed_.wait_for(lock, stop, kBetween, [this] { return !shown_; });
    }
}

}  // namespace metier::dashboard
