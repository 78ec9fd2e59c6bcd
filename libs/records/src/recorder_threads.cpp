#include "recorder_threads.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "presence.hpp"

namespace metier::records {
namespace {

using namespace std::chrono_literals;

/// How long messages are gathered before they are written together.
constexpr auto kGather = 250ms;
constexpr auto kRetry = 1s;
constexpr auto kTrimEvery = 1h;
constexpr auto kWatchEvery = 250ms;
/// To put a sample into a ring that is full.
constexpr int kAttempts = 8;

SteadyTime now() {
    return std::chrono::steady_clock::now();
}

std::uint64_t sumOf(const Dropped& dropped) {
    return dropped.executions + dropped.events + dropped.samples;
}

/// What comes faster is made rows of later: messages of so many in a second, and at once.
constexpr double kFloodRate = 4'000;
constexpr std::size_t kFloodLeast = 500;
/// Later than this it is made rows of however fast more comes.
constexpr auto kMostBehind = 10s;
/// A backlog of so many messages takes no more; what comes then waits in the queue.
constexpr std::uint64_t kMostBacklog = 2'000'000;
/// How long rows are made of a backlog when the recorder ends; of the rest the next start makes
/// them.
constexpr auto kLongestEnd = 2s;

constexpr int kNice = 15;

/// Where every core is busy, robots come first: what is recorded then waits in the queue.
void yieldToOthers() {
    // Of this thread alone. Should the system refuse it, the writer is one thread among others.
    const sched_param no_priority{};
    static_cast<void>(sched_setscheduler(0, SCHED_BATCH, &no_priority));
    static_cast<void>(setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice));
}

std::string lossText(const Dropped& d) {
    return fmt::format("{} executions, {} transitions and results and {} samples of paths",
                       d.executions, d.events, d.samples);
}

}  // namespace

Recorder::Impl::Impl(Options options)
    : options_(std::move(options)),
      samples_(options_.most_waiting_samples),
      writer_(options_.server, options_.to_json),
      backlog_(options_.server) {
    watcher_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
    thread_ = std::jthread([this](const std::stop_token& stop) { write(stop); });
}

Recorder::Impl::~Impl() {
    thread_.request_stop();
    thread_ = {};
    watcher_.request_stop();
    watcher_ = {};
}

template <typename... Messages>
Recorder::Key Recorder::Impl::begin(const Messages&... messages) {
    const std::lock_guard lock(mutex_);
    if (waiting_.count() >= options_.most_waiting) {
        ++dropped_.executions;
        return 0;
    }
    const auto before = waiting_.count();
    waiting_.put(++newest_, messages...);
    wakeWriter(before);
    return newest_;
}

template Recorder::Key Recorder::Impl::begin(const ExecutionView& execution);
template Recorder::Key Recorder::Impl::begin(const ExecutionView& execution,
                                             const TransitionView& first);
template Recorder::Key Recorder::Impl::begin(const WholeExecution& whole);

template <typename Message>
void Recorder::Impl::tell(Key key, const Message& message) {
    if (key == 0) {
        return;
    }
    const std::lock_guard lock(mutex_);
    if (waiting_.count() >= options_.most_waiting) {
        ++dropped_.events;
    } else {
        const auto before = waiting_.count();
        waiting_.put(key, message);
        wakeWriter(before);
    }
}

template void Recorder::Impl::tell(Key key, const TransitionView& message);
template void Recorder::Impl::tell(Key key, const IntermediateView& message);

/// An execution ends once, so that beyond the queue's size there are never more than began.
template <typename... Messages>
void Recorder::Impl::end(Key key, const Messages&... messages) {
    if (key == 0) {
        return;
    }
    const std::lock_guard lock(mutex_);
    const auto before = waiting_.count();
    waiting_.put(key, messages...);
    wakeWriter(before);
}

template void Recorder::Impl::end(Key key, const OutcomeView& outcome);
template void Recorder::Impl::end(Key key, const TransitionView& last, const OutcomeView& outcome);

/// With the lock, after each message. Only when the writer has something to wait for no longer,
/// since waking a thread costs more than all else here.
/// \param before how many were waiting before it
void Recorder::Impl::wakeWriter(std::size_t before) {
    const auto many = options_.most_waiting / 2;
    if (before == 0 || (before <= many && waiting_.count() > many)) {
        changed_.notify_all();
    }
}

void Recorder::Impl::sample(const KeyedSample& sample) noexcept {
    if (sample.key == 0) {
        return;
    }
    // Whoever holds up the ring may have a lower priority: it is not waited for.
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        if (samples_.tryPut(sample)) {
            return;
        }
        if (samples_.tryTake()) {
            dropped_samples_.fetch_add(1, std::memory_order_relaxed);
        }
    }
    dropped_samples_.fetch_add(1, std::memory_order_relaxed);
}

bool Recorder::Impl::flush(SteadyTime deadline) {
    std::unique_lock lock(mutex_);
    const auto ticket = ++asked_;
    changed_.notify_all();
    return changed_.wait_until(lock, deadline, [&] { return answered_ >= ticket; });
}

Recorder::Status Recorder::Impl::status() const {
    const std::lock_guard lock(mutex_);
    return {.health = told_,
            .waiting = waiting_.count() + behind_,
            .waiting_samples = samples_.size(),
            .written = written_,
            .dropped = dropped()};
}

/// With the lock.
Dropped Recorder::Impl::dropped() const {
    auto all = dropped_;
    all.samples += dropped_samples_.load(std::memory_order_relaxed);
    return all;
}

void Recorder::Impl::write(const std::stop_token& stop) {
    yieldToOthers();
    std::optional<SteadyTime> end;
    while (true) {
        const bool go_on = waitForWork(stop);
        if (!go_on && !end) {
            end = now() + kLongestEnd;
        }
        const auto done = writeRound(!go_on);
        finishRound(done);
        if (!go_on && (!done || !somethingWaits(now() < *end))) {
            return;
        }
        if (!done) {
            std::unique_lock lock(mutex_);
            changed_.wait_for(lock, stop, kRetry, [] { return false; });
        }
    }
}

/// False if nothing will come any more: all is written.
bool Recorder::Impl::waitForWork(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    const auto asked = [this] { return asked_ > answered_; };
    if (!writer_busy_ && !trimming_ && database_ != nullptr) {
        changed_.wait_for(lock, stop, kTrimEvery, [&] { return waiting_.count() > 0 || asked(); });
    }
    if (database_ != nullptr && !trimming_ && !isBacklogDue(false)) {
        changed_.wait_for(lock, stop, kGather,
                          [&] { return asked() || waiting_.count() > options_.most_waiting / 2; });
    }
    unwritten_since_ = unwritten_since_.value_or(now());
    return !stop.stop_requested();
}

Result<void> Recorder::Impl::writeRound(bool everything) {
    {
        const std::lock_guard lock(mutex_);
        everything = everything || asked_ > answered_;
    }
    auto done = database_ == nullptr ? openStore() : Result<void>();
    if (done && !isTaken()) {
        takeWaiting(everything);
    }
    if (done) {
        done = writeTaken();
    }
    if (done && isBacklogDue(everything)) {
        done = workOffBacklog();
    }
    if (done) {
        done = trim();
    }
    if (!done && done.error().code != Errc::timeout) {
        database_.reset();  // after a timeout it is as good as before, and tells that this is there
    }
    if (!done) {
        trimming_.reset();
    }
    return done;
}

/// Whether something was taken that could not be written: no more is taken until it is, since the
/// queue is bounded.
bool Recorder::Impl::isTaken() const {
    return adds_ || works_off_ || writer_.hasChanges();
}

void Recorder::Impl::takeWaiting(bool everything) {
    const auto passed = now() - taken_at_;
    bool newly_asked = false;
    {
        const std::lock_guard lock(mutex_);
        // While a backlog is worked off, what comes is added to it in few pieces.
        const bool early = !backlog_.isEmpty() && passed < kGather &&
                           waiting_.count() <= options_.most_waiting / 2;
        if (early || backlog_.messages() > kMostBacklog) {
            return;
        }
        std::swap(waiting_, taken_);
        newly_asked = answered_ == asked_then_;
        asked_then_ = newly_asked ? asked_ : asked_then_;
    }
    taken_at_ = now();
    const auto count = taken_.count();
    // What waits came within the last of these, unless the store held the writer up.
    const std::chrono::duration<double> came = std::min<SteadyTime::duration>(passed, 2 * kGather);
    flooded_ = count >= kFloodLeast && static_cast<double>(count) > kFloodRate * came.count();
    const auto samples = takeSamples();
    if (backlog_.isEmpty() && (everything || !flooded_)) {
        lose(writer_.take(taken_, samples));
    } else if (count > 0 || !samples.empty()) {
        makeTold(taken_, samples, for_backlog_);
        adds_ = true;
    }
    if (newly_asked) {
        asked_piece_ = backlog_.next() - (adds_ ? 0 : 1);
    }
    taken_.clear();
}

Result<void> Recorder::Impl::writeTaken() {
    if (adds_) {
        auto added = backlog_.add(*database_, for_backlog_, writer_.underWay());
        adds_ = !added;
        return added;
    }
    return works_off_ ? makeRowsOfOldest() : writer_.write(*database_);
}

Result<void> Recorder::Impl::makeRowsOfOldest() {
    bool there = true;
    auto done = inTransaction(*database_, [&]() -> Result<void> {
        const auto removed = backlog_.removeOldest(*database_);
        if (!removed) {
            return fail(removed.error());
        }
        there = *removed;
        if (!there) {
            return writer_.goOnWithStore(*database_);
        }
        auto written = writer_.writeWithin(*database_);
        return written ? backlog_.noteUnderWay(*database_, writer_.underWay()) : written;
    });
    if (!done) {
        writer_.undone();
        return done;
    }
    if (there) {
        writer_.kept();
    }
    backlog_.oldestRemoved();
    works_off_ = false;
    return {};
}

bool Recorder::Impl::isBacklogDue(bool everything) const {
    return !backlog_.isEmpty() && (everything || !flooded_ || backlog_.messages() > kMostBacklog ||
                                   now() - backlog_.oldest() > kMostBehind);
}

/// Of the backlog the oldest.
Result<void> Recorder::Impl::workOffBacklog() {
    const auto told = backlog_.readOldest(*database_);
    if (!told) {
        return fail(told.error());
    }
    if (*told) {
        lose(writer_.take(**told));
    }
    if (backlog_.isOldestInDoubt()) {
        writer_.doubt();
    }
    works_off_ = true;
    return writeTaken();
}

void Recorder::Impl::lose(const Dropped& lost) {
    const std::lock_guard lock(mutex_);
    dropped_ += lost;
}

std::vector<KeyedSample> Recorder::Impl::takeSamples() {
    std::vector<KeyedSample> taken;
    // Not more than fit: others may put as fast as this takes.
    for (std::size_t i = 0; i < samples_.capacity(); ++i) {
        const auto sample = samples_.tryTake();
        if (!sample) {
            break;
        }
        taken.push_back(*sample);
    }
    return taken;
}

/// For the store, or, if that is asked for, for its rows as well.
bool Recorder::Impl::somethingWaits(bool for_rows) const {
    const std::lock_guard lock(mutex_);
    return waiting_.count() > 0 || isTaken() || (for_rows && !backlog_.isEmpty());
}

Result<void> Recorder::Impl::openStore() {
    auto opened = openDatabase(options_.url, Store::Access::write);
    if (!opened) {
        return fail(opened.error());
    }
    const auto opening = opened_ ? Opening::again : Opening::first;
    auto attended = attend(**opened, options_.server, opening, options_.to_json);
    if (!attended) {
        return fail(attended.error());
    }
    presence_ = std::move(attended->presence);
    lose(attended->lost);
    opened_ = true;
    database_ = std::move(*opened);
    return {};
}

/// A part of it: what is told meanwhile is written in between.
Result<void> Recorder::Impl::trim() {
    if (!trimming_ && (!trimmed_ || now() - *trimmed_ >= kTrimEvery)) {
        const auto lost = closeLostOfOthers(*database_, options_.server, options_.to_json);
        if (!lost) {
            return fail(lost.error());
        }
        lose(*lost);
        trimmed_ = now();
        trimming_.emplace(options_.keep, std::chrono::system_clock::now());
    }
    if (!trimming_) {
        return {};
    }
    const auto more = trimming_->step(*database_);
    if (!more) {
        return fail(more.error());
    }
    if (!*more) {
        trimming_.reset();
    }
    return {};
}

void Recorder::Impl::finishRound(const Result<void>& done) {
    {
        const std::lock_guard lock(mutex_);
        const bool in_the_way = !done && done.error().code == Errc::timeout;
        error_ = done || in_the_way ? std::string() : done.error().message;
        if (done && (backlog_.isEmpty() || backlog_.first() > asked_piece_)) {
            answered_ = asked_then_;
        }
        written_ = writer_.written();
        behind_ = backlog_.messages() + (adds_ ? for_backlog_.messages : 0);
        writer_busy_ = isTaken() || writer_.isBusy() || !backlog_.isEmpty();
        if (done) {
            unwritten_since_.reset();
        }
    }
    changed_.notify_all();
}

void Recorder::Impl::watch(const std::stop_token& stop) {
    bool last = false;
    while (!last) {
        std::optional<HealthReport> report;
        {
            std::unique_lock lock(mutex_);
            changed_.wait_for(lock, stop, kWatchEvery, [] { return false; });
            last = stop.stop_requested();
            report = news();
        }
        if (report && options_.on_health) {
            options_.on_health(*report);
        }
    }
}

/// With the lock.
bool Recorder::Impl::hangs() const {
    return unwritten_since_ && now() - *unwritten_since_ > options_.patience;
}

/// With the lock. Nothing if all is as it was told.
std::optional<HealthReport> Recorder::Impl::news() {
    const auto lost = dropped();
    const bool new_loss = sumOf(lost) > std::exchange(told_dropped_, sumOf(lost));
    const bool fails = !error_.empty() || hangs() || new_loss;
    const auto health = fails ? Health::failing : Health::writing;
    if (health == std::exchange(told_, health)) {
        return std::nullopt;
    }
    if (!fails) {
        return HealthReport{health, "executions are recorded again; lost are " + lossText(lost),
                            lost};
    }
    const auto why = !error_.empty() ? error_
                     : hangs()       ? options_.url + " takes too long"
                                     : "more comes than can be written";
    return HealthReport{health, "executions are not recorded: " + why, lost};
}

}  // namespace metier::records
