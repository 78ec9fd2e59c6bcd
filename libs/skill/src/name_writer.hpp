#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "metier/base/clock.hpp"
#include "metier/skill/name_file.hpp"

namespace metier::skill {

/// Thread that writes names to their file, so that no other thread waits for the disk.
///
/// Threading: any. The destructor waits for the write that is under way, and for those in the
/// queue.
class NameWriter {
public:
    struct Job {
        std::string line;
        bool begins_anew = false;                  ///< the file, before this line
        std::function<void(Result<void>)> done{};  ///< called once, on the writing thread
    };

    /// \param longest_wait for one name, after which no more are taken
    NameWriter(std::unique_ptr<NameFile> file, std::chrono::milliseconds longest_wait);
    ~NameWriter();
    NameWriter(const NameWriter&) = delete;
    NameWriter& operator=(const NameWriter&) = delete;

    /// Errors: resource_unavailable: the disk hangs.
    Result<void> add(Job job);

private:
    void run(const std::stop_token& stop);
    Result<void> write(const Job& job);

    const std::unique_ptr<NameFile> file_;
    const std::chrono::milliseconds longest_wait_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::deque<Job> waiting_;
    std::optional<SteadyTime> writing_since_;
    bool begins_anew_ = false;  ///< used by the thread only: the file must be begun anew
    std::jthread thread_;       // last: it uses everything above
};

}  // namespace metier::skill
