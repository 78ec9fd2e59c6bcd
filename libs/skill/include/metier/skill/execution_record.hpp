#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "metier/base/clock.hpp"
#include "metier/skill/caller.hpp"
#include "metier/skill/parent_execution.hpp"
#include "metier/skill/state.hpp"
#include "metier/skill/value.hpp"

namespace metier::skill {

/// Facts that a server keeps of one execution.
/// A value: a copy does not change when the execution goes on.
struct ExecutionRecord {
    /// ExecutionId, given by the client, or made by the Program as its random prefix and a number.
    std::string id{};
    /// Client that started it, as its session was then.
    Caller client{};
    /// Execution on whose behalf it was started, as the starter claims; empty: none.
    ParentExecution parent{};
    /// Parameters at Start. Shared with the recorder; does not change.
    std::shared_ptr<const ValueMap> parameters{};
    /// Present state, or the state in which it ended: ready (finished, or reset while suspended) or
    /// halted.
    State state = State::running;
    /// Reason of its latest transition; by_client from its Start on.
    Reason reason = Reason::none;
    /// Text for a person, with value, limit and unit; may be empty.
    std::string reason_text{};
    /// Wall clock of the server at the Start.
    UtcTime start_time{};
    /// Wall clock at the transition that ended it; UtcTime{} while it is not over.
    UtcTime end_time{};
    /// Values by the names of the declared results; empty unless it finished.
    ValueMap result{};
};

/// The last kMost executions of one Program; older ones are forgotten.
///
/// Threading: the owner's thread.
class ExecutionHistory {
public:
    /// Number of executions that are remembered per Program.
    static constexpr std::size_t kMost = 64;

    /// The record of that id, or nullptr. Valid until the next add().
    /// \param id compared with upper and lower case
    const ExecutionRecord* find(std::string_view id) const noexcept {
        const auto found = std::find_if(records_.begin(), records_.end(),
                                        [&](const auto& record) { return record.id == id; });
        return found == records_.end() ? nullptr : &*found;
    }
    /// Adds the latest execution; the oldest is forgotten if there are more than kMost.
    void add(ExecutionRecord record) {
        if (records_.size() == kMost) {
            records_.pop_front();
        }
        records_.push_back(std::move(record));
    }
    /// The latest execution; there must be one.
    ExecutionRecord& last() noexcept { return records_.back(); }
    /// The execution `back` places before the latest, or nullptr. Valid until the next add().
    const ExecutionRecord* recent(std::size_t back) const noexcept {
        return back < records_.size() ? &records_[records_.size() - 1 - back] : nullptr;
    }

private:
    // At most kMost, in the order of their Start.
    std::deque<ExecutionRecord> records_;  // oldest first
};

}  // namespace metier::skill
