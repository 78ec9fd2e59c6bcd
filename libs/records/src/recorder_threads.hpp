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

#include "backlog.hpp"
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

    template <typename... Messages>
    Key begin(const Messages&... messages);
    template <typename Message>
    void tell(Key key, const Message& message);
    template <typename... Messages>
    void end(Key key, const Messages&... messages);
    void sample(const KeyedSample& sample) noexcept;
    bool flush(SteadyTime deadline);
    Status status() const;

private:
    void wakeWriter(std::size_t before);
    void write(const std::stop_token& stop);
    bool somethingWaits(bool for_rows) const;
    bool waitForWork(const std::stop_token& stop);
    Result<void> writeRound(bool everything);
    void takeWaiting(bool everything);
    std::vector<KeyedSample> takeSamples();
    bool isTaken() const;
    Result<void> writeTaken();
    bool isBacklogDue(bool everything) const;
    Result<void> workOffBacklog();
    Result<void> makeRowsOfOldest();
    void lose(const Dropped& lost);
    Result<void> openStore();
    Result<void> trim();
    void finishRound(const Result<void>& done);

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
    std::uint64_t behind_ = 0;                   // messages that were taken and are no rows yet
    bool writer_busy_ = false;                   // has something to write, or executions under way
    std::optional<SteadyTime> unwritten_since_;  // begin of the first round since one went well
    std::string error_;  // of the last round; empty: it went well, or others were in the way
    Health told_ = Health::writing;
    std::uint64_t told_dropped_ = 0;
    // ---- of the writer's thread alone
    std::unique_ptr<Database> database_;
    Presence presence_;
    MessageLog taken_;     // changes places with what is waiting
    bool opened_ = false;  // once
    Writer writer_;
    Backlog backlog_;
    Told for_backlog_;
    bool adds_ = false;       // that to the backlog
    bool works_off_ = false;  // the writer has the oldest of the backlog
    bool flooded_ = false;    // more came last than rows are made of at once
    SteadyTime taken_at_{};
    std::uint64_t asked_then_ = 0;  // flushes that what was taken by then answers
    std::int64_t asked_piece_ = 0;  // of the backlog, that holds the last of it
    std::optional<RetentionRun> trimming_;
    std::optional<SteadyTime> trimmed_;
    // ----
    std::jthread watcher_;
    std::jthread thread_;
};

}  // namespace metier::records
