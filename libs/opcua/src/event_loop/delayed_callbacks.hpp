#pragma once

#include <open62541/plugin/eventloop.h>

#include <deque>

namespace metier::opcua {

/// Work the stack puts off until nothing of it is on the call stack, mostly freeing its own memory.
///
/// Threading: one thread, or under the loop's mutex.
class DelayedCallbacks {
public:
    void add(UA_DelayedCallback* callback) { queue_.push_back(callback); }
    void remove(UA_DelayedCallback* callback) { std::erase(queue_, callback); }
    bool empty() const { return queue_.empty(); }
    /// Calls, oldest first, those that wait now; what they add waits for the next run.
    /// A callback may remove others, and free its own memory.
    void run() {
        for (auto left = queue_.size(); left > 0 && !queue_.empty(); --left) {
            const auto* delayed = queue_.front();
            queue_.pop_front();
            if (delayed->callback != nullptr) {
                delayed->callback(delayed->application, delayed->context);
            }
        }
    }

private:
    std::deque<UA_DelayedCallback*> queue_;
};

}  // namespace metier::opcua
