#include "writer.hpp"

#include <algorithm>

#include "text.hpp"

namespace metier::records {
namespace {

/// Transitions and intermediate results that are kept of one execution.
constexpr std::size_t kMostEvents = 100'000;

}  // namespace

Dropped Writer::take(Batch batch) {
    dropped_ = {};
    for (auto& message : batch.messages) {
        std::visit([&](auto& content) { take(message.key, std::move(content)); }, message.content);
    }
    for (const auto& sample : batch.samples) {
        take(sample);
    }
    return dropped_;
}

void Writer::take(Recorder::Key key, std::unique_ptr<ExecutionRow> execution) {
    execution->server = server_;
    makeStorable(*execution);
    auto& active = active_[key];
    active.execution = std::move(*execution);
    note(key, active);
}

void Writer::take(Recorder::Key key, Transition transition) {
    auto* active = findForEvent(key);
    if (active == nullptr) {
        return;
    }
    makeStorable(transition);
    auto& execution = active->execution;
    if (execution.state != transition.to) {
        execution.state = transition.to;
        execution.reason = transition.reason;
        execution.reason_text = transition.reason_text;
        active->row_changed = true;
    }
    active->events.emplace_back(std::move(transition));
    note(key, *active);
}

void Writer::take(Recorder::Key key, Intermediate intermediate) {
    if (auto* active = findForEvent(key)) {
        makeStorable(intermediate);
        active->events.emplace_back(std::move(intermediate));
        note(key, *active);
    }
}

void Writer::take(Recorder::Key key, Outcome outcome) {
    auto* active = find(key);
    if (active == nullptr) {
        ++dropped_.events;
        return;
    }
    makeStorable(outcome);
    auto& execution = active->execution;
    execution.ended = std::max(outcome.time, execution.started);
    execution.state = std::move(outcome.state);
    execution.reason = std::move(outcome.reason);
    execution.reason_text = std::move(outcome.reason_text);
    execution.result = std::move(outcome.result);
    execution.missed_cycles = outcome.missed_cycles;
    active->row_changed = true;
    note(key, *active);
}

void Writer::take(const KeyedSample& sample) {
    auto* active = find(sample.key);
    if (active == nullptr || active->parts >= kMostParts) {
        ++dropped_.samples;
        return;
    }
    encodeSample(sample.sample, active->samples);
    note(sample.key, *active);
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
    RowWriter rows(database, kinds_);
    METIER_TRY(rows.takeRevisions(static_cast<std::int64_t>(changed_.size())));
    for (const auto key : changed_) {
        METIER_TRY(writeOne(rows, key, active_.at(key)));
    }
    return {};
}

Result<void> Writer::writeOne(RowWriter& rows, Recorder::Key key, Active& active) {
    auto& execution = active.execution;
    if (execution.number == 0) {
        numbered_.push_back(key);
        METIER_ASSIGN(const auto there,
                      in_doubt_ ? rows.numberOf(execution) : Result<std::int64_t>(0));
        execution.number = there;
    }
    if (active.row_changed) {
        METIER_TRY(rows.save(execution));
    }
    return active.hasPart() ? rows.addPart(execution.number * kMostParts + active.parts,
                                           encodeEvents(active.events), active.samples)
                            : Result<void>();
}

/// All that was written is in the store.
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

/// Nothing of it is, unless the answer to the commit was lost.
void Writer::undone() {
    for (const auto key : numbered_) {
        active_.at(key).execution.number = 0;
    }
    numbered_.clear();
    kinds_.clear();
    in_doubt_ = true;
}

}  // namespace metier::records
