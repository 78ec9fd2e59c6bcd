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
struct ExecutionRecord {
    std::string id{};          ///< ExecutionId, given by the client or the Program
    Caller client{};           ///< client that started it
    ParentExecution parent{};  ///< execution on whose behalf it was started
    /// Parameters at Start. Shared with the recorder; does not change.
    std::shared_ptr<const ValueMap> parameters{};
    State state = State::running;  ///< present state, or the state in which it ended
    Reason reason = Reason::none;  ///< reason of the latest transition
    std::string reason_text{};     ///< for a person, with value, limit and unit; may be empty
    UtcTime start_time{};
    UtcTime end_time{};  ///< UtcTime{} while it is not over
    ValueMap result{};   ///< empty unless it finished
};

/// The last kMost executions of one Program; older ones are forgotten.
///
/// Threading: the owner's thread.
class ExecutionHistory {
public:
    static constexpr std::size_t kMost = 64;

    /// The record of that id, or nullptr. Valid until the next add().
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
    std::deque<ExecutionRecord> records_;  // oldest first
};

}  // namespace metier::skill
