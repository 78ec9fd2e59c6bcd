#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

namespace metier {

/// Longest time that a server's thread waits for a read. A read from a healthy disk takes about a
/// millisecond; a busy computer can delay a thread by some 50 ms.
constexpr std::chrono::milliseconds kReadPatience{100};

/// Reads files on a thread of its own, for a caller that must not wait long for a disk, such as a
/// server's thread that checks a user.
///
///     BackgroundRead<Users> users(std::make_shared<const Users>(), readUsersIfChanged);
///     const auto now = users.get();
///
/// Threading: get() from any thread; it waits for its patience at most. The destructor waits for a
/// read that is under way, without a limit if the disk hangs.
template <typename T>
class BackgroundRead {
public:
    /// Reads the files, or returns `last` if nothing has changed. Runs on the reading thread; must
    /// not return null and must not throw.
    using Read = std::function<std::shared_ptr<const T>(const std::shared_ptr<const T>& last)>;

    /// \param first    result of get() until the first read has ended; not null
    /// \param patience longest time that get() waits for a read
    BackgroundRead(std::shared_ptr<const T> first, Read read,
                   std::chrono::milliseconds patience = kReadPatience)
        : patience_(patience),
          newest_(std::move(first)),
          read_(std::move(read)),
          thread_([this](const auto& stop) { run(stop); }) {}

    /// Asks for a new read and returns its contents; those of the last read if the new one takes
    /// longer than the patience. While such a slow read is under way, get() returns at once. Never
    /// null; the contents never change.
    ///
    /// Callers share one reading thread: a read that begins after the call answers it, so several
    /// calls at the same time may be answered by one read. The first caller that meets a hanging
    /// disk waits for the patience; the next ones do not wait until that read has ended.
    std::shared_ptr<const T> get() {
        std::unique_lock lock(mutex_);
        const auto wanted = ++asked_;
        changed_.notify_all();
        if (!hangs_) {
            hangs_ = !changed_.wait_for(lock, patience_, [&] { return done_ >= wanted; });
        }
        return newest_;
    }

private:
    /// Body of the reading thread. Calls read_ without the lock, so that get() never waits for more
    /// than its patience. After a stop request it ends once every call is answered.
    void run(const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        while (changed_.wait(lock, stop, [this] { return done_ < asked_; })) {
            const auto answers = asked_;
            const auto last = newest_;
            lock.unlock();
            auto read = read_(last);
            lock.lock();
            newest_ = std::move(read);
            done_ = answers;
            hangs_ = false;
            changed_.notify_all();
        }
    }

    // Numbers of reads count up from 1: a call of get() is answered as soon as done_ has reached
    // the number that it drew from asked_.
    const std::chrono::milliseconds patience_;
    std::mutex mutex_;  // guards all members but patience_, read_ and thread_
    std::condition_variable_any changed_;
    std::uint64_t asked_ = 0;
    std::uint64_t done_ = 0;  ///< value of asked_ that the last finished read answers
    bool hangs_ = false;      ///< a read has taken longer than the patience
    std::shared_ptr<const T> newest_;
    const Read read_;
    std::jthread thread_;  // last: it uses everything above
};

}  // namespace metier
