#include "records_view.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "live_values.hpp"
#include "metier/base/text.hpp"
#include "skill_shown.hpp"

namespace metier::dashboard {

using nlohmann::json;
using records::Execution;
using records::Store;

namespace {

/// JSON of a record's text, with frames as lists; null if there is none.
json parsed(const std::string& text) {
    auto value = text.empty() ? json() : json::parse(text, nullptr, false);
    return value.is_discarded() ? json(text) : inLists(value);
}

json timeOrNull(UtcTime time) {
    return time == UtcTime{} ? json() : json(secondsOf(time));
}

json jsonOf(const records::Transition& one) {
    return {{"time", secondsOf(one.time)},   {"from", one.from}, {"to", one.to},
            {"sub_state", one.sub_state},    {"step", one.step}, {"reason", one.reason},
            {"reason_text", one.reason_text}};
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

/// Of a long path as many samples as a page can draw, the first and the last among them.
json pathJson(const std::vector<records::PathSample>& path) {
    constexpr std::size_t kMost = 20'000;
    const auto kept = std::min(path.size(), kMost);
    auto list = json::array();
    for (std::size_t i = 0; i < kept; ++i) {
        list.push_back(jsonOf(path[thinned(i, kept, path.size())]));
    }
    return list;
}

template <typename T>
json listOf(const std::vector<T>& all) {
    auto list = json::array();
    for (const auto& one : all) {
        list.push_back(jsonOf(one));
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
    auto from = timeIn(request, "from");
    auto until = from ? timeIn(request, "to") : from;
    const auto before =
        wholeIn(request, "before", {0, std::numeric_limits<std::int64_t>::max()}, 0);
    const auto count = wholeIn(request, "count", {1, kMostRecords}, kUsual);
    if (!until || !before || !count) {
        return fail(!until ? until.error() : !before ? before.error() : count.error());
    }
    filter.from = *from;
    filter.until = *until;
    return std::pair{std::move(filter), records::Page{*before, static_cast<std::uint32_t>(*count)}};
}

RecordsView::RecordsView(std::string url, Board& board)
    : url_(std::move(url)),
      board_(board),
      thread_([this](const std::stop_token& stop) { work(stop); }) {}

Result<std::unique_ptr<Store>> RecordsView::open() const {
    return url_.empty() ? fail(Errc::not_found, "nothing is recorded") : Store::open(url_);
}

json RecordsView::recordJson(const Execution& execution) const {
    const auto arm = board_.armOf(execution.server, execution.controller, execution.skill);
    return {{"number", execution.number},
            {"id", execution.id},
            {"server", execution.server},
            {"server_name", execution.server_name},
            {"skill", execution.skill},
            {"controller", execution.controller},
            {"device", execution.device},
            {"arm", arm.empty() ? json() : json(arm)},
            {"parent", execution.parent},
            {"parent_server", execution.parent_server},
            {"session", execution.session},
            {"client_name", execution.client_name},
            {"user", execution.user},
            {"thumbprint", execution.thumbprint},
            {"parameters", parsed(execution.parameters)},
            {"check", parsed(execution.check)},
            {"started", secondsOf(execution.started)},
            {"ended", timeOrNull(execution.ended)},
            {"state", execution.state},
            {"reason", execution.reason},
            {"reason_text", execution.reason_text},
            {"result", parsed(execution.result)},
            {"missed_cycles", execution.missed_cycles}};
}

Reply RecordsView::list(const httplib::Request& request) const {
    const auto query = recordsQuery(request);
    if (!query) {
        return errorReply(query.error());
    }
    auto store = open();
    if (!store && store.error().code == Errc::not_found) {
        return {200, {{"records", json::array()}, {"more", false}}};  // nothing yet
    }
    const auto listing = store ? (*store)->list(query->first, query->second)
                               : Result<records::Listing>(fail(store.error()));
    if (!listing) {
        return errorReply(listing.error());
    }
    auto list = json::array();
    for (const auto& execution : listing->executions) {
        list.push_back(recordJson(execution));
    }
    return {200, {{"records", std::move(list)}, {"more", listing->more}}};
}

Reply RecordsView::one(std::int64_t number) const {
    auto store = open();
    const auto execution =
        store ? (*store)->find(std::to_string(number)) : Result<Execution>(fail(store.error()));
    if (!execution) {
        return errorReply(execution.error());
    }
    const auto transitions = (*store)->transitions(number);
    const auto children = (*store)->children(number);
    const auto path = (*store)->path(number);
    if (!transitions || !children || !path) {
        return errorReply(!transitions ? transitions.error()
                          : !children  ? children.error()
                                       : path.error());
    }
    auto shown = recordJson(*execution);
    shown["transitions"] = listOf(*transitions);
    shown["path"] = pathJson(*path);
    shown["children"] = json::array();
    for (const auto& child : *children) {
        shown["children"].push_back(recordJson(child));
    }
    return {200, std::move(shown)};
}

void RecordsView::show(bool shown) {
    {
        const std::lock_guard lock(mutex_);
        shown_ = shown;
    }
    changed_.notify_all();
}

void RecordsView::look(std::unique_ptr<Store>& store, std::int64_t& revision) const {
    if (!store) {
        auto opened = open();
        const auto latest =
            opened ? (*opened)->latestRevision() : Result<std::int64_t>(fail(opened.error()));
        if (latest) {
            store = std::move(*opened);
            revision = *latest;
        }
        return;
    }
    const auto changes = store->changes(revision);
    if (!changes) {
        store.reset();  // opened again next time
        return;
    }
    revision = changes->revision;
    for (const auto& execution : changes->executions) {
        board_.noteRecord(execution.number);
    }
}

void RecordsView::work(const std::stop_token& stop) {
    constexpr std::chrono::milliseconds kBetween{500};
    std::unique_ptr<Store> store;
    std::int64_t revision = 0;
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested() && !url_.empty()) {
        if (!shown_) {
            store.reset();
            changed_.wait(lock, stop, [this] { return shown_; });
            continue;
        }
        lock.unlock();
        look(store, revision);
        lock.lock();
        changed_.wait_for(lock, stop, kBetween, [this] { return !shown_; });
    }
}

}  // namespace metier::dashboard
