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

/// Keeps the contents of files for a thread that must not wait for a disk: another thread reads
/// them.
///
/// Threading: get() from any thread. The end waits for a read that is under way.
template <typename T>
class BackgroundRead {
public:
    /// Reads, or returns `last` if nothing has changed; never null. Runs on the thread of this.
    using Read = std::function<std::shared_ptr<const T>(const std::shared_ptr<const T>& last)>;

    /// How long get() may wait for a read. One of a disk that works takes about a millisecond; a
    /// busy computer delays a thread by some 50 ms.
    static constexpr std::chrono::milliseconds kPatience{100};

    /// \param first result of get() until something was read; not null
    BackgroundRead(std::shared_ptr<const T> first, Read read)
        : newest_(std::move(first)),
          read_(std::move(read)),
          thread_([this](const auto& stop) { run(stop); }) {}

    /// The contents now; those of the last read if a new one takes longer than kPatience. While
    /// such a read is under way nobody waits.
    std::shared_ptr<const T> get() {
        std::unique_lock lock(mutex_);
        const auto wanted = ++asked_;
        changed_.notify_all();
        if (!hangs_) {
            hangs_ = !changed_.wait_for(lock, kPatience, [&] { return done_ >= wanted; });
        }
        return newest_;
    }

private:
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

    std::mutex mutex_;  // of all but read_
    std::condition_variable_any changed_;
    std::uint64_t asked_ = 0;
    std::uint64_t done_ = 0;  ///< of those asked, by the read that ended last
    bool hangs_ = false;      ///< a read has taken longer than kPatience
    std::shared_ptr<const T> newest_;
    const Read read_;
    std::jthread thread_;  // last: it uses everything above
};

}  // namespace metier
