#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <variant>

#include "metier/records/execution_row.hpp"
#include "metier/records/recorder.hpp"

namespace metier::records {

/// Begin, event or end of an execution on its way from the skill to the writer.
struct Message {
    Recorder::Key key = 0;
    // The pointer: an execution is three times as large as the others.
    std::variant<std::unique_ptr<ExecutionRow>, Transition, Intermediate, Outcome> content{};
};

/// Memory that it takes, about [byte].
std::size_t sizeOf(const Message& message);

/// A sample and the execution that it belongs to.
struct KeyedSample {
    Recorder::Key key = 0;
    PathSample sample{};
};

/// All that came since the batch before, in its order.
struct Batch {
    std::deque<Message> messages{};
    std::deque<KeyedSample> samples{};
    std::size_t bytes = 0;  ///< total size of the messages

    bool isEmpty() const noexcept { return messages.empty() && samples.empty(); }
};

}  // namespace metier::records
