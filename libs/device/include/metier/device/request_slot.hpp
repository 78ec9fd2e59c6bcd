#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "metier/base/error.hpp"

namespace metier::device {

/// One request at a time on its way from any thread to the thread that serves the device, and its
/// end on the way back: post() on the caller's thread, take() and end() on the serving one,
/// dispatch() and with it `done` on the notifying one.
///
/// A request stays until its end was dispatched. A request that is still here when the slot is
/// destroyed is never answered.
/// Threading: as each function says. The serving thread neither locks nor allocates here, but in
/// open() and close() and as far as moving an End allocates.
///
///     slot.post(request, [](Result<Outcome> end) { ... });             // any thread
///     if (const auto* request = slot.take()) { begin(*request); }      // serving thread
///     if (arrived) { slot.end(Outcome{...}); notifier.signal(); }      // serving thread
///     slot.dispatch();                                                 // notifying thread
template <typename Request, typename End>
class RequestSlot {
public:
    /// Callback for the end of a request; called without a lock, may post the next request.
    /// Runs on the thread that calls dispatch(); must not throw.
    using Done = std::function<void(End)>;

    /// Hands over a request.
    /// Any thread. A stop() that came before does not count for this request.
    /// \param done called once, by dispatch(), if the request is accepted
    /// Errors: resource_unavailable while another request is here; the error that close() was given
    Result<void> post(Request request, Done done) {
        const std::lock_guard lock(mutex_);
        if (closed_) {
            return fail(*closed_);
        }
        if (job_) {
            return fail(Errc::resource_unavailable, "another motion runs");
        }
        job_ = std::make_unique<Job>(Job{std::move(request), std::move(done)});
        stop_.store(false);
        new_.store(&job_->request);
        posted_.store(&job_->request);
        return {};
    }
    /// Whether a request is here whose end was not dispatched. Locks.
    /// Any thread.
    bool occupied() const {
        const std::lock_guard lock(mutex_);
        return job_ != nullptr;
    }
    /// Asks to stop the request that is here now. Nothing happens if none is. Does not wait.
    /// Any thread. The serving thread sees it by takeStop(); it decides when the request ends.
    void stop() noexcept { stop_.store(posted_.load() != nullptr); }

    // ---- the serving thread ----
    /// The request that has not ended; nullptr: none. Valid until end().
    const Request* posted() const noexcept { return posted_.load(); }
    /// Whether take() would give a request.
    bool waiting() const noexcept { return new_.load() != nullptr; }
    /// The request that was not taken before; nullptr: none. Valid until end().
    const Request* take() noexcept { return new_.exchange(nullptr); }
    /// Whether a stop was asked for since the last call or the last post().
    /// Several calls of stop() count as one.
    bool takeStop() noexcept { return stop_.load() && stop_.exchange(false); }
    /// Ends the request that is here, taken or not. Nothing happens if none is, or if it has ended.
    /// Signal the notifying thread afterwards.
    /// \param how  handed to `done` by dispatch(), on the other thread
    void end(End how) noexcept {
        if (posted_.load() == nullptr) {
            return;
        }
        new_.store(nullptr);
        end_ = std::move(how);
        posted_.store(nullptr);
        ended_.store(true);
    }
    /// Whether dispatch() has something to report.
    bool toTell() const noexcept { return ended_.load(); }
    /// Accepts requests again; so does a new slot.
    /// open() and close() lock; a request that is here keeps its end.
    void open() {
        const std::lock_guard lock(mutex_);
        closed_.reset();
    }
    /// Refuses requests with this error from now on, such as connection_lost. A request that is
    /// here still has to be ended.
    void close(Error why) {
        const std::lock_guard lock(mutex_);
        closed_ = std::move(why);
    }

    /// Reports the end to the caller of post(); nothing happens if there is none. The slot is free
    /// for the next request before that.
    /// Notifying thread. Must be called once more after the serving thread has ended, or the last
    /// end is lost.
    void dispatch() {
        if (!ended_.exchange(false)) {
            return;
        }
        std::optional<End> how = std::exchange(end_, std::nullopt);
        std::unique_ptr<Job> job;
        {
            const std::lock_guard lock(mutex_);
            job = std::move(job_);
        }
        job->done(std::move(*how));
    }

private:
    /// A request with its callback; at one address until dispatch(), since the serving thread has a
    /// pointer to it.
    struct Job {
        Request request;
        Done done;
    };

    // Written by post() and end(). Both pointers lead into job_; end() clears them before
    // dispatch() destroys it, so the serving thread never follows one that is gone.
    std::atomic<const Request*> posted_{nullptr};
    std::atomic<const Request*> new_{nullptr};
    std::atomic<bool> stop_{false};
    std::atomic<bool> ended_{false};
    std::optional<End> end_;  // of the serving thread until ended_, then of the notifying one

    // Guards job_ and closed_.
    mutable std::mutex mutex_;
    std::unique_ptr<Job> job_;
    std::optional<Error> closed_;
};

}  // namespace metier::device
