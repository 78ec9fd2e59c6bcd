#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <vector>

namespace metier::opcua {

/// Work for one thread from any.
///
/// Threading: push() and close() any, drain() the one.
class WorkQueue {
public:
    enum class Pushed { first, further, refused };

    /// \return first if the queue was empty and its thread must be woken
    Pushed push(std::function<void()> work);
    /// Does what was there at the beginning, oldest first, without holding the lock.
    void drain(const std::function<void(const std::function<void()>&)>& run);
    /// Any thread.
    std::size_t size() const;
    /// Refuses more. \return what waited and will not be done
    [[nodiscard]] std::vector<std::function<void()>> close();

private:
    std::vector<std::function<void()>> takeAll();

    mutable std::mutex mutex_;
    std::vector<std::function<void()>> waiting_;
    bool closed_ = false;
};

}  // namespace metier::opcua
