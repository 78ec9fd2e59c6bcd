#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "message_log.hpp"
#include "metier/records/recorder.hpp"
#include "retention.hpp"
#include "sample_ring.hpp"
#include "writer.hpp"

namespace metier::records {

/// The queue of a recorder, the thread that writes, and the thread that tells how that goes also
/// while the first one hangs in a call to the disk.
class Recorder::Impl {
public:
    explicit Impl(Options options);
    ~Impl();
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    Key begin(const Execution& execution, ToJson to_json);
    template <typename Message>
    void tell(Key key, const Message& message);
    void end(Key key, const Outcome& outcome);
    void sample(const KeyedSample& sample) noexcept;
    bool flush(SteadyTime deadline);
    Status status() const;

private:
    void wakeWriter();
    void write(const std::stop_token& stop);
    bool somethingWaits() const;
    bool waitForWork(const std::stop_token& stop);
    std::uint64_t giveToWriter();
    std::vector<KeyedSample> takeSamples();
    Result<void> writeRound(std::uint64_t& answered);
    Result<void> openStore();
    Result<void> trim();
    void finishRound(const Result<void>& done, std::uint64_t answered);

    void watch(const std::stop_token& stop);
    bool hangs() const;
    std::optional<HealthReport> news();
    Dropped dropped() const;

    const Options options_;
    SampleRing<KeyedSample> samples_;
    std::atomic<std::uint64_t> dropped_samples_{0};

    mutable std::mutex mutex_;  // what follows, until the line
    std::condition_variable_any changed_;
    MessageLog waiting_;
    Key newest_ = 0;
    Dropped dropped_;             // its samples: those that the writer found too much
    std::uint64_t asked_ = 0;     // flushes
    std::uint64_t answered_ = 0;  // flushes
    std::uint64_t written_ = 0;
    bool writer_busy_ = false;  // has changes that are not in the store, or executions under way
    std::optional<SteadyTime> round_began_;
    std::string error_;  // of the last round; empty: it went well
    Health told_ = Health::writing;
    std::uint64_t told_dropped_ = 0;
    // ---- of the writer's thread alone
    std::unique_ptr<Database> database_;
    MessageLog taken_;     // changes places with what is waiting
    bool opened_ = false;  // once
    Writer writer_;
    std::optional<RetentionRun> trimming_;
    std::optional<SteadyTime> trimmed_;
    // ----
    std::jthread watcher_;
    std::jthread thread_;
};

}  // namespace metier::records
