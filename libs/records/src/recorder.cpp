#include "metier/records/recorder.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <type_traits>
#include <utility>

#include "lost_executions.hpp"
#include "messages.hpp"
#include "retention.hpp"
#include "writer.hpp"

namespace metier::records {
namespace {

using namespace std::chrono_literals;

/// Time for which messages are gathered before they are written together.
constexpr auto kGather = 250ms;
constexpr auto kRetry = 1s;
constexpr auto kTrimEvery = 1h;
constexpr auto kWatchEvery = 250ms;

SteadyTime now() {
    return std::chrono::steady_clock::now();
}

/// Makes this thread wait longer for a core, so that robots come first where every core is busy:
/// the writer keeps its share of the time, but does not interrupt a running thread.
void yieldToOthers() {
    // For this thread alone. Should the system refuse it, the writer is one thread among others.
    const sched_param no_priority{};
    static_cast<void>(sched_setscheduler(0, SCHED_BATCH, &no_priority));
}

std::string lossText(const Dropped& d) {
    return fmt::format("{} executions, {} transitions and results and {} samples of paths",
                       d.executions, d.events, d.samples);
}

/// Queue of a recorder, the thread that writes, and the thread that reports its write_state, even
/// while the first one hangs in a call to the disk.
class QueueRecorder final : public Recorder {
public:
    explicit QueueRecorder(Options options);
    ~QueueRecorder() override;
    QueueRecorder(const QueueRecorder&) = delete;
    QueueRecorder& operator=(const QueueRecorder&) = delete;

    Key begin(ExecutionRow execution) override;
    void transition(Key key, Transition transition) override { put(key, std::move(transition)); }
    void intermediate(Key key, Intermediate intermediate) override {
        put(key, std::move(intermediate));
    }
    void sample(Key key, const PathSample& sample) override;
    void end(Key key, Outcome outcome) override { put(key, std::move(outcome)); }
    bool flush(SteadyTime deadline) override;
    Status status() const override;

private:
    template <typename Event>
    void put(Key key, Event event);
    bool isFull(std::size_t more) const;
    void append(Message message, std::size_t size);
    void write(const std::stop_token& stop);
    bool waitForWork(const std::stop_token& stop);
    Result<void> writeRound();
    void takeWaiting();
    Result<void> openStore();
    Result<void> trim();
    Result<void> trimPart();
    void finishRound(const Result<void>& done);
    bool isIdle() const;

    void watch(const std::stop_token& stop);
    bool hangs() const;
    std::optional<WriteReport> news();

    const Options options_;

    mutable std::mutex mutex_;  // guards all that follows, until the line
    std::condition_variable_any changed_;
    Batch waiting_;
    std::size_t taken_ = 0;        // messages that the writer has and are not written yet
    std::size_t taken_bytes_ = 0;  // the same
    Key newest_ = 0;
    Dropped dropped_;
    std::uint64_t asked_ = 0;     // flushes
    std::uint64_t answered_ = 0;  // flushes
    std::uint64_t written_ = 0;
    std::optional<SteadyTime> unwritten_since_;  // begin of the first round since one went well
    std::string error_;  // of the last round; empty: it succeeded, or others held the lock
    WriteState reported_ = WriteState::writing;
    std::uint64_t reported_loss_ = 0;
    // ---- used by the writer's thread alone
    std::unique_ptr<Database> database_;
    Presence presence_;
    bool opened_ = false;  // once
    Writer writer_;
    std::uint64_t asked_then_ = 0;  // flushes that the taken batch answers
    std::optional<RetentionRun> trimming_;
    SteadyTime next_trim_{};
    // ----
    std::jthread watcher_;
    std::jthread thread_;
};

QueueRecorder::QueueRecorder(Options options)
    : options_(std::move(options)), writer_(options_.server) {
    watcher_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
    thread_ = std::jthread([this](const std::stop_token& stop) { write(stop); });
}

QueueRecorder::~QueueRecorder() {
    thread_.request_stop();
    thread_ = {};
    watcher_.request_stop();
    watcher_ = {};
}

Recorder::Key QueueRecorder::begin(ExecutionRow execution) {
    Message message{.content = std::make_unique<ExecutionRow>(std::move(execution))};
    const auto size = sizeOf(message);
    const std::lock_guard lock(mutex_);
    if (isFull(size)) {
        ++dropped_.executions;
        return 0;
    }
    message.key = ++newest_;
    append(std::move(message), size);
    return newest_;
}

template <typename Event>
void QueueRecorder::put(Key key, Event event) {
    if (key == 0) {
        return;
    }
    Message message{key, std::move(event)};
    const auto size = sizeOf(message);
    // An execution ends once, so that beyond the queue's size there are never more ends than began.
    const bool ends = std::is_same_v<Event, Outcome>;
    const std::lock_guard lock(mutex_);
    if (!ends && isFull(size)) {
        ++dropped_.events;
    } else {
        append(std::move(message), size);
    }
}

void QueueRecorder::sample(Key key, const PathSample& sample) {
    if (key == 0) {
        return;
    }
    const std::lock_guard lock(mutex_);
    if (waiting_.isEmpty()) {
        changed_.notify_all();
    }
    if (waiting_.samples.size() >= options_.most_waiting_samples) {
        waiting_.samples.pop_front();
        ++dropped_.samples;
    }
    waiting_.samples.push_back({key, sample});
}

/// With the lock.
bool QueueRecorder::isFull(std::size_t more) const {
    return waiting_.bytes + taken_bytes_ + more > options_.most_waiting;
}

/// With the lock. Wakes the writer only when it has something to wait for no longer, since waking a
/// thread costs more than all else here.
void QueueRecorder::append(Message message, std::size_t size) {
    const auto many = options_.most_waiting / 2;
    const bool was_many = waiting_.bytes > many;
    if (waiting_.isEmpty() || (!was_many && waiting_.bytes + size > many)) {
        changed_.notify_all();
    }
    waiting_.bytes += size;
    waiting_.messages.push_back(std::move(message));
}

bool QueueRecorder::flush(SteadyTime deadline) {
    std::unique_lock lock(mutex_);
    const auto ticket = ++asked_;
    changed_.notify_all();
    return changed_.wait_until(lock, deadline, [&] { return answered_ >= ticket; });
}

Recorder::Status QueueRecorder::status() const {
    const std::lock_guard lock(mutex_);
    return {.write_state = reported_,
            .waiting = waiting_.messages.size() + taken_,
            .waiting_samples = waiting_.samples.size(),
            .written = written_,
            .dropped = dropped_};
}

void QueueRecorder::write(const std::stop_token& stop) {
    yieldToOthers();
    while (true) {
        const bool go_on = waitForWork(stop);
        const auto done = writeRound();
        finishRound(done);
        if (!go_on && (!done || isIdle())) {
            return;
        }
        if (!done) {
            std::unique_lock lock(mutex_);
            changed_.wait_for(lock, stop, kRetry, [] { return false; });
        }
    }
}

/// False if nothing will come any more: all is written.
bool QueueRecorder::waitForWork(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    const auto asked = [this] { return asked_ > answered_; };
    if (database_ != nullptr && !trimming_ && !writer_.hasChanges()) {
        changed_.wait_until(lock, stop, next_trim_, [&] { return !waiting_.isEmpty() || asked(); });
    }
    if (database_ != nullptr && !trimming_) {
        changed_.wait_for(lock, stop, kGather,
                          [&] { return asked() || waiting_.bytes > options_.most_waiting / 2; });
    }
    unwritten_since_ = unwritten_since_.value_or(now());
    return !stop.stop_requested();
}

Result<void> QueueRecorder::writeRound() {
    auto done = database_ == nullptr ? openStore() : Result<void>();
    // While a batch could not be written no more is taken: the queue is bounded.
    if (done && !writer_.hasChanges()) {
        takeWaiting();
    }
    if (done) {
        done = writer_.write(*database_);
    }
    if (done) {
        done = trim();
    }
    if (!done && done.error().code != Errc::timeout) {
        // Not after a timeout: the store still works, and keeps showing that this server is there.
        database_.reset();
        trimming_.reset();
    }
    return done;
}

void QueueRecorder::takeWaiting() {
    Batch batch;
    {
        const std::lock_guard lock(mutex_);
        std::swap(batch, waiting_);
        taken_ = batch.messages.size();
        taken_bytes_ = batch.bytes;
        asked_then_ = asked_;
    }
    const auto lost = writer_.take(std::move(batch));
    const std::lock_guard lock(mutex_);
    dropped_ += lost;
}

Result<void> QueueRecorder::openStore() {
    METIER_ASSIGN(auto opened, openDatabase(options_.url, Store::Access::write));
    METIER_ASSIGN(auto attended,
                  attend(*opened, options_.server, opened_ ? Opening::again : Opening::first));
    presence_ = std::move(attended);
    opened_ = true;
    database_ = std::move(opened);
    writer_.reopened();
    return {};
}

/// Trims the store. If others hold the lock nothing is lost: it goes on in the next round.
Result<void> QueueRecorder::trim() {
    auto done = trimPart();
    return !done && done.error().code == Errc::timeout ? Result<void>() : done;
}

/// Messages that come meanwhile are written between two parts.
Result<void> QueueRecorder::trimPart() {
    if (!trimming_ && now() >= next_trim_) {
        METIER_TRY(closeLostOfOthers(*database_, options_.server));
        next_trim_ = now() + kTrimEvery;
        trimming_.emplace(options_.keep, std::chrono::system_clock::now());
    }
    if (!trimming_) {
        return {};
    }
    METIER_ASSIGN(const auto more, trimming_->step(*database_));
    if (!more) {
        trimming_.reset();
    }
    return {};
}

void QueueRecorder::finishRound(const Result<void>& done) {
    {
        const std::lock_guard lock(mutex_);
        const bool in_the_way = !done && done.error().code == Errc::timeout;
        error_ = done || in_the_way ? std::string() : done.error().message;
        if (!writer_.hasChanges()) {
            taken_ = 0;
            taken_bytes_ = 0;
        }
        if (done) {
            answered_ = asked_then_;
            unwritten_since_.reset();
        }
        written_ = writer_.written();
    }
    changed_.notify_all();
}

bool QueueRecorder::isIdle() const {
    const std::lock_guard lock(mutex_);
    return waiting_.isEmpty() && !writer_.hasChanges();
}

void QueueRecorder::watch(const std::stop_token& stop) {
    bool last = false;
    while (!last) {
        std::optional<WriteReport> report;
        {
            std::unique_lock lock(mutex_);
            changed_.wait_for(lock, stop, kWatchEvery, [] { return false; });
            last = stop.stop_requested();
            report = news();
        }
        if (report && options_.on_write_state) {
            options_.on_write_state(*report);
        }
    }
}

/// With the lock.
bool QueueRecorder::hangs() const {
    return unwritten_since_ && now() - *unwritten_since_ > options_.patience;
}

/// With the lock. Nothing if all is as it was reported.
std::optional<WriteReport> QueueRecorder::news() {
    const auto lost = dropped_.sum();
    const bool new_loss = lost > std::exchange(reported_loss_, lost);
    const bool fails = !error_.empty() || hangs() || new_loss;
    const auto write_state = fails ? WriteState::failing : WriteState::writing;
    if (write_state == std::exchange(reported_, write_state)) {
        return std::nullopt;
    }
    if (!fails) {
        return WriteReport{
            write_state, "executions are recorded again; lost are " + lossText(dropped_), dropped_};
    }
    const auto why = !error_.empty() ? error_
                     : hangs()       ? options_.url + " takes too long"
                                     : "more comes than can be written";
    return WriteReport{write_state, "executions are not recorded: " + why, dropped_};
}

}  // namespace

Result<std::unique_ptr<Recorder>> Recorder::create(Options options) {
    METIER_TRY(checkUrl(options.url));
    if (options.server.empty()) {
        return fail(Errc::invalid_argument, "records need the name of their server");
    }
    return std::make_unique<QueueRecorder>(std::move(options));
}

}  // namespace metier::records
