#pragma once

#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"

namespace metier::dashboard {

/// A message of the stream as it is sent; shared by all tabs that get it.
using Message = std::shared_ptr<const std::string>;

/// A server-sent event of that name. Text that is not UTF-8 is replaced.
Message makeMessage(std::string_view event, const nlohmann::json& data);

/// JSON as text, in one line, whatever text is in it.
std::string dump(const nlohmann::json& value);

/// Queue of messages to one tab.
///
/// Adding a message never waits: a tab with too much in its queue is given up.
/// Threading: any.
class Outbox {
public:
    /// \param most_bytes that may wait
    explicit Outbox(std::size_t most_bytes) : most_bytes_(most_bytes) {}

    void push(Message message);
    /// All that waits; nothing at the deadline, or once it is over and empty.
    std::vector<Message> take(SteadyTime deadline);
    void close();
    /// Nothing more will come; what waits is not worth sending if the tab was too slow.
    bool isClosed() const;

private:
    const std::size_t most_bytes_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<Message> waiting_;
    std::size_t bytes_ = 0;
    bool closed_ = false;
};

}  // namespace metier::dashboard
