#include "metier/skill/execution_record.hpp"

#include <algorithm>
#include <utility>

namespace metier::skill {

const ExecutionRecord* ExecutionHistory::find(std::string_view id) const noexcept {
    const auto found = std::find_if(records_.begin(), records_.end(),
                                    [&](const ExecutionRecord& record) { return record.id == id; });
    return found == records_.end() ? nullptr : &*found;
}

ExecutionRecord* ExecutionHistory::find(std::string_view id) noexcept {
    const auto found = std::find_if(records_.begin(), records_.end(),
                                    [&](const ExecutionRecord& record) { return record.id == id; });
    return found == records_.end() ? nullptr : &*found;
}

void ExecutionHistory::add(ExecutionRecord record) {
    if (records_.size() == kMost) {
        records_.pop_front();
    }
    records_.push_back(std::move(record));
}

}  // namespace metier::skill
