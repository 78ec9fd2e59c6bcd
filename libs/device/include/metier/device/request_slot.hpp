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
/// end on the way back.
///
/// A request stays until its end was dispatched. A request that is still here when the slot is
/// destroyed is never answered.
/// Threading: as each function says. The serving thread neither locks nor allocates here, but in
/// open() and close() and as far as moving an End allocates.
template <typename Request, typename End>
/// One request at a time on its way from any thread to the thread that serves the device, and its
/// end on the way back: post() on the caller's thread, take() and end() on the serving one,
/// dispatch() and with it `done` on the notifying one.
///
/// A request stays until its end was dispatched. A request that is still here when the slot is
/// destroyed is never answered.
/// Threading: as each function says. The serving thread neither locks nor allocates here, but in
/// open() and close() and as far as moving an End allocates.
class RequestSlot {
public:
    /// Callback for the end of a request; called without a lock, may post the next request.
    using Done = std::function<void(End)>;

    /// Hands over a request.
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
    bool occupied() const {
        const std::lock_guard lock(mutex_);
        return job_ != nullptr;
    }
    /// Asks to stop the request that is here now. Nothing happens if none is. Does not wait.
    void stop() noexcept { stop_.store(posted_.load() != nullptr); }

    // ---- the serving thread ----
    /// The request that has not ended; nullptr: none. Valid until end().
    const Request* posted() const noexcept { return posted_.load(); }
    /// Whether take() would give a request.
    bool waiting() const noexcept { return new_.load() != nullptr; }
    /// The request that was not taken before; nullptr: none. Valid until end().
    const Request* take() noexcept { return new_.exchange(nullptr); }
    /// Whether a stop was asked for since the last call or the last post().
    bool takeStop() noexcept { return stop_.load() && stop_.exchange(false); }
    /// Ends the request that is here, taken or not. Nothing happens if none is, or if it has ended.
    /// Signal the notifying thread afterwards.
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
    struct Job {
        Request request;
        Done done;
    };

    std::atomic<const Request*> posted_{nullptr};
    std::atomic<const Request*> new_{nullptr};
    std::atomic<bool> stop_{false};
    std::atomic<bool> ended_{false};
    std::optional<End> end_;  // of the serving thread until ended_, then of the notifying one

    mutable std::mutex mutex_;
    std::unique_ptr<Job> job_;
    std::optional<Error> closed_;
};

}  // namespace metier::device
