#pragma once

#include <chrono>
#include <functional>
#include <utility>

namespace metier::skill {

/// A piece of work that will run later; destroying the Timer cancels it, so keep it as a member of
/// the object that the work uses.
///
/// Threading: the owner's thread.
///
///     timer_ = executor.after(100ms, [this] { look(); });  // cancels the one before
class Timer {
public:
    /// A Timer without work: cancel() does nothing.
    Timer() = default;
    /// \param cancel called at most once, may be called while the work itself runs
    explicit Timer(std::function<void()> cancel) : cancel_(std::move(cancel)) {}
    /// Cancels the work, unless it has begun.
    ~Timer() { cancel(); }
    /// The moved-from Timer has no work.
    Timer(Timer&& other) noexcept : cancel_(std::exchange(other.cancel_, nullptr)) {}
    /// Cancels the work that this Timer had before.
    Timer& operator=(Timer&& other) noexcept {
        if (this != &other) {
            cancel();
            cancel_ = std::exchange(other.cancel_, nullptr);
        }
        return *this;
    }
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;

    /// Prevents the work from beginning. Does nothing to work that has begun, or on a second call.
    void cancel() {
        if (auto cancel = std::exchange(cancel_, nullptr)) {
            cancel();
        }
    }

private:
    std::function<void()> cancel_;
};

/// The thread that owns Programs; in a server, the server thread.
///
/// Shared by the Programs and their Executions; whichever lets go last destroys it, and the work in
/// its queue, on any thread. Once its own thread has ended it drops posted work.
class Executor {
public:
    virtual ~Executor() = default;
    /// Runs `work` on the owner's thread, after all work posted before, never inside this call.
    /// \param work must not block; dropped unrun if the owner's thread has ended
    /// Threads: any, but no cycle thread: it allocates and may lock. Does not wait.
    virtual void post(std::function<void()> work) = 0;
    /// Runs `work` on the owner's thread once `delay` has passed and the Timer still exists.
    /// \param delay by the monotonic clock; 0 or less: as soon as possible, not inside this call
    /// \param work  must not block; may destroy its own Timer
    /// Threads: the owner's.
    [[nodiscard]] virtual Timer after(std::chrono::nanoseconds delay,
                                      std::function<void()> work) = 0;
};

}  // namespace metier::skill
