#include "writer.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "backlog.hpp"
#include "text.hpp"

namespace metier::records {
namespace {

/// Of one execution.
constexpr std::size_t kMostEvents = 100'000;
constexpr std::string_view kLostText = "the server ended while this was under way";

template <typename... Texts>
void cut(std::size_t longest, Texts&... texts) {
    const auto cut_one = [longest](auto& text) {
        if (!isStorable(text, longest)) {
            text = storable(text, longest);
        }
    };
    (cut_one(texts), ...);
}

/// How many it has.
Result<std::int64_t> partsOf(Database& database, std::int64_t execution) {
    const auto rows = database.query(
        "SELECT coalesce(max(part) + 1 - $1, 0) FROM parts WHERE part >= $1 AND part < $2",
        std::array<Cell, 2>{execution * kMostParts, (execution + 1) * kMostParts});
    return rows ? Result<std::int64_t>(rows->front().integer(0))
                : Result<std::int64_t>(fail(rows.error()));
}

/// The latest time that is known of an execution under way.
Result<UtcTime> lastHeardOf(Database& database, const Execution& execution) {
    const auto rows = database.query(
        "SELECT events, samples FROM parts WHERE part >= $1 AND part < $2 ORDER BY part DESC "
        "LIMIT 1",
        std::array<Cell, 2>{execution.number * kMostParts, (execution.number + 1) * kMostParts});
    if (!rows) {
        return fail(rows.error());
    }
    auto last = execution.started;
    if (rows->empty()) {
        return last;
    }
    std::vector<Event> events;
    decodeEvents(rows->front().text(0), events);
    for (const auto& event : events) {
        last = std::max(last, std::visit([](const auto& one) { return one.time; }, event));
    }
    std::vector<PathSample> samples;
    decodeSamples(rows->front().bytes(1), samples);
    if (!samples.empty()) {
        const std::chrono::duration<double> time(samples.back().time);
        last =
            std::max(last, execution.started + std::chrono::duration_cast<UtcTime::duration>(time));
    }
    return last;
}

}  // namespace

Dropped Writer::take(const MessageLog& messages, const std::vector<KeyedSample>& samples) {
    dropped_ = {};
    messages.giveTo(*this);
    const auto early = std::exchange(early_, {});
    takeSamples(early);
    takeSamples(samples);
    return dropped_;
}

Dropped Writer::take(std::span<const std::uint8_t> told) {
    dropped_ = {};
    std::vector<KeyedSample> samples;
    dropped_.events += giveTold(told, *this, samples);
    const auto early = std::exchange(early_, {});
    takeSamples(early);
    takeSamples(samples);
    return dropped_;
}

void Writer::makeJson(std::string& value) const {
    if (to_json_ != nullptr && !value.empty()) {
        value = to_json_(value);
    }
}

void Writer::take(Recorder::Key key, Execution&& e) {
    if (e.parameters != parameters_.from) {
        parameters_ = {.from = e.parameters, .json = e.parameters};
        makeJson(parameters_.json);
    }
    e.parameters = parameters_.json;
    e.server = server_;
    cut(kLongestName, e.server, e.server_name, e.skill, e.controller, e.device, e.user, e.state,
        e.reason, e.session, e.client_name, e.thumbprint, e.parent_server);
    cut(kLongestKey, e.id, e.parent, e.reason_text);
    cut(kLongestText, e.parameters, e.check, e.result);
    newest_ = std::max(newest_, key);
    auto& active = active_[key];
    active.execution = std::move(e);
    note(key, active);
}

void Writer::take(Recorder::Key key, Transition&& t) {
    auto* active = findForEvent(key);
    if (active == nullptr) {
        return;
    }
    cut(kLongestName, t.from, t.to, t.sub_state, t.step, t.reason);
    cut(kLongestKey, t.reason_text);
    auto& execution = active->execution;
    if (execution.state != t.to) {
        execution.state = t.to;
        execution.reason = t.reason;
        execution.reason_text = t.reason_text;
        active->row_changed = true;
    }
    active->events.emplace_back(std::move(t));
    note(key, *active);
}

void Writer::take(Recorder::Key key, Intermediate&& intermediate) {
    if (auto* active = findForEvent(key)) {
        makeJson(intermediate.value);
        cut(kLongestText, intermediate.value);
        active->events.emplace_back(std::move(intermediate));
        note(key, *active);
    }
}

void Writer::take(Recorder::Key key, Outcome&& o) {
    auto* active = find(key);
    if (active == nullptr) {
        ++dropped_.events;  // another server made rows of its begin, and closed it
        return;
    }
    makeJson(o.result);
    cut(kLongestName, o.state, o.reason);
    cut(kLongestKey, o.reason_text);
    cut(kLongestText, o.result);
    auto& execution = active->execution;
    execution.ended = std::max(o.time, execution.started);
    execution.state = std::move(o.state);
    execution.reason = std::move(o.reason);
    execution.reason_text = std::move(o.reason_text);
    execution.result = std::move(o.result);
    execution.missed_cycles = o.missed_cycles;
    active->row_changed = true;
    note(key, *active);
}

void Writer::takeSamples(const std::vector<KeyedSample>& samples) {
    for (const auto& sample : samples) {
        dropped_.samples += takeSample(sample) ? 0 : 1;
    }
}

bool Writer::takeSample(const KeyedSample& sample) {
    auto* active = find(sample.key);
    if (active == nullptr && sample.key > newest_) {
        early_.push_back(sample);
        return true;
    }
    if (active == nullptr || active->parts >= kMostParts) {
        return false;
    }
    encodeSample(sample.sample, active->samples);
    note(sample.key, *active);
    return true;
}

Writer::Active* Writer::find(Recorder::Key key) {
    const auto found = active_.find(key);
    return found == active_.end() ? nullptr : &found->second;
}

Writer::Active* Writer::findForEvent(Recorder::Key key) {
    auto* active = find(key);
    if (active == nullptr || active->events_kept >= kMostEvents || active->parts >= kMostParts) {
        ++dropped_.events;
        return nullptr;
    }
    ++active->events_kept;
    return active;
}

void Writer::note(Recorder::Key key, Active& active) {
    if (!std::exchange(active.changed, true)) {
        changed_.push_back(key);
    }
}

Result<void> Writer::write(Database& database) {
    if (changed_.empty()) {
        return {};
    }
    auto done = inTransaction(database, [&] { return writeWithin(database); });
    if (done) {
        kept();
    } else {
        undone();
    }
    return done;
}

Result<void> Writer::writeWithin(Database& database) {
    if (changed_.empty()) {
        return {};
    }
    RowWriter rows(database, kinds_);
    if (auto taken = rows.takeRevisions(static_cast<std::int64_t>(changed_.size())); !taken) {
        return taken;
    }
    for (const auto key : changed_) {
        if (auto written = writeOne(rows, key, active_.at(key)); !written) {
            return written;
        }
    }
    return {};
}

Result<void> Writer::writeOne(RowWriter& rows, Recorder::Key key, Active& active) {
    auto& execution = active.execution;
    if (execution.number == 0) {
        numbered_.push_back(key);
        const auto there = in_doubt_ ? rows.numberOf(execution) : Result<std::int64_t>(0);
        if (!there) {
            return fail(there.error());
        }
        execution.number = *there;
    }
    if (active.row_changed) {
        if (auto saved = rows.save(execution); !saved) {
            return saved;
        }
    }
    if (!active.hasPart()) {
        return {};
    }
    return rows.addPart(execution.number * kMostParts + active.parts, encodeEvents(active.events),
                        active.samples);
}

void Writer::kept() {
    for (const auto key : changed_) {
        auto& active = active_.at(key);
        if (active.execution.isOver()) {
            active_.erase(key);
            continue;
        }
        active.parts += active.hasPart() ? 1 : 0;
        active.events.clear();
        active.samples.clear();
        active.row_changed = false;
        active.changed = false;
    }
    written_ += numbered_.size();
    numbered_.clear();
    changed_.clear();
    in_doubt_ = false;
}

void Writer::undone() {
    for (const auto key : numbered_) {
        active_.at(key).execution.number = 0;
    }
    numbered_.clear();
    kinds_.clear();
    in_doubt_ = true;
}

/// An array for each: key, number, parts and events kept.
std::string Writer::underWay() const {
    auto all = nlohmann::json::array();
    for (const auto& [key, active] : active_) {
        if (!active.execution.isOver()) {
            all.push_back({key, active.execution.number, active.parts + (active.hasPart() ? 1 : 0),
                           active.events_kept});
        }
    }
    return all.dump();
}

Result<void> Writer::goOnWith(Database& database, std::string_view under_way) {
    const auto all = nlohmann::json::parse(under_way, nullptr, false);
    for (const auto& one : all.is_array() ? all : nlohmann::json::array()) {
        const bool whole = one.is_array() && one.size() == 4 &&
                           std::all_of(one.begin(), one.end(), [](const auto& number) {
                               return number.is_number_unsigned();
                           });
        if (!whole) {
            continue;
        }
        Active active{.events_kept = one[3], .row_changed = false};
        active.parts = std::min<std::int64_t>(one[2].get<std::uint32_t>(), kMostParts);
        active.execution.number = one[1];
        const auto found = readRow(database, active.execution);
        if (!found) {
            return fail(found.error());
        }
        if (*found) {
            const auto parts = partsOf(database, active.execution.number);
            if (!parts) {
                return fail(parts.error());
            }
            active.parts = std::max(active.parts, *parts);
            active.execution.ended = {};  // others may have closed it
            const Recorder::Key key = one[0];
            newest_ = std::max(newest_, key);
            active_[key] = std::move(active);
        }
    }
    return {};
}

/// The row of its number; false if there is none of this server.
Result<bool> Writer::readRow(Database& database, Execution& execution) const {
    const auto rows = database.query(std::string("SELECT ") + std::string(kExecutionColumns) +
                                         " FROM history WHERE number = $1 AND server = $2",
                                     std::array<Cell, 2>{execution.number, server_});
    if (!rows) {
        return fail(rows.error());
    }
    if (!rows->empty()) {
        execution = toExecution(rows->front());
    }
    return !rows->empty();
}

Result<void> Writer::goOnWithStore(Database& database) {
    RowWriter rows(database, kinds_);
    changed_.clear();
    numbered_.clear();
    for (auto it = active_.begin(); it != active_.end();) {
        auto& active = it->second;
        active.events.clear();
        active.samples.clear();
        active.changed = false;
        // The other one has the end from the same message.
        const auto over =
            active.execution.isOver() ? Result<bool>(true) : isOverInStore(rows, database, active);
        if (!over) {
            return fail(over.error());
        }
        if (*over) {
            it = active_.erase(it);
            continue;
        }
        active.row_changed = true;  // the other one has closed it
        note(it->first, active);
        ++it;
    }
    return {};
}

/// Takes over what its row, if it has one, tells.
Result<bool> Writer::isOverInStore(RowWriter& rows, Database& database, Active& active) {
    auto stored = active.execution;
    const auto number =
        stored.number == 0 ? rows.numberOf(stored) : Result<std::int64_t>(stored.number);
    if (!number) {
        return fail(number.error());
    }
    stored.number = *number;
    const auto found = readRow(database, stored);
    if (!found) {
        return fail(found.error());
    }
    const auto parts = partsOf(database, *number);
    if (!parts) {
        return fail(parts.error());
    }
    active.parts = *parts;
    if (*found && stored.state != kLost) {
        active.execution = std::move(stored);
        return active.execution.isOver();
    }
    active.execution.number = *found ? *number : 0;
    return false;
}

Result<void> Writer::closeLost(Database& database, const std::string& server) {
    const auto rows =
        database.query(std::string("SELECT ") + std::string(kExecutionColumns) +
                           " FROM history WHERE ended = 0 AND server = $1 ORDER BY number",
                       std::array<Cell, 1>{server});
    if (!rows) {
        return fail(rows.error());
    }
    KindCache kinds;
    RowWriter writer(database, kinds);
    auto done = writer.takeRevisions(static_cast<std::int64_t>(rows->size()));
    for (std::size_t i = 0; done && i < rows->size(); ++i) {
        auto execution = toExecution((*rows)[i]);
        const auto ended = lastHeardOf(database, execution);
        if (!ended) {
            return fail(ended.error());
        }
        execution.ended = *ended;
        execution.state = kLost;
        execution.reason = kServerLost;
        execution.reason_text = kLostText;
        done = writer.save(execution);
    }
    return done;
}

}  // namespace metier::records
