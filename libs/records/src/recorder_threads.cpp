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
      writer_(options_.server) {
    watcher_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
    thread_ = std::jthread([this](const std::stop_token& stop) { write(stop); });
}

Recorder::Impl::~Impl() {
    thread_.request_stop();
    thread_ = {};
    watcher_.request_stop();
    watcher_ = {};
}

Recorder::Key Recorder::Impl::begin(const Execution& execution, ToJson to_json) {
    const std::lock_guard lock(mutex_);
    if (waiting_.count() >= options_.most_waiting) {
        ++dropped_.executions;
        return 0;
    }
    waiting_.put(++newest_, execution, to_json);
    wakeWriter();
    return newest_;
}

template <typename Message>
void Recorder::Impl::tell(Key key, const Message& message) {
    if (key == 0) {
        return;
    }
    const std::lock_guard lock(mutex_);
    if (waiting_.count() >= options_.most_waiting) {
        ++dropped_.events;
    } else {
        waiting_.put(key, message);
        wakeWriter();
    }
}

template void Recorder::Impl::tell(Key key, const Transition& message);
template void Recorder::Impl::tell(Key key, const Intermediate& message);

/// An execution ends once, so that beyond the queue's size there are never more than began.
void Recorder::Impl::end(Key key, const Outcome& outcome) {
    if (key == 0) {
        return;
    }
    const std::lock_guard lock(mutex_);
    waiting_.put(key, outcome);
    wakeWriter();
}

/// With the lock, after each message. Only when the writer has something to wait for no longer,
/// since waking a thread costs more than all else here.
void Recorder::Impl::wakeWriter() {
    if (waiting_.count() == 1 || waiting_.count() == options_.most_waiting / 2 + 1) {
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
            .waiting = waiting_.count(),
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
    while (true) {
        const bool go_on = waitForWork(stop);
        std::uint64_t answered = 0;
        const auto done = writeRound(answered);
        finishRound(done, answered);
        if (!go_on && (!done || !somethingWaits())) {
            return;
        }
        if (!done) {
            std::unique_lock lock(mutex_);
            changed_.wait_for(lock, stop, kRetry, [] { return false; });
        }
    }
}

/// False if nothing will come any more: one last round.
bool Recorder::Impl::waitForWork(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    const auto asked = [this] { return asked_ > answered_; };
    if (!writer_busy_ && !trimming_ && database_ != nullptr) {
        changed_.wait_for(lock, stop, kTrimEvery, [&] { return waiting_.count() > 0 || asked(); });
    }
    if (database_ != nullptr && !trimming_) {
        changed_.wait_for(lock, stop, kGather,
                          [&] { return asked() || waiting_.count() > options_.most_waiting / 2; });
    }
    round_began_ = now();
    return !stop.stop_requested();
}

/// Gives the writer what waits, unless it still has what it could not write: the queue is bounded.
/// \return which flush is answered once that is written
std::uint64_t Recorder::Impl::giveToWriter() {
    if (writer_.hasChanges()) {
        return 0;
    }
    std::uint64_t asked = 0;
    {
        const std::lock_guard lock(mutex_);
        std::swap(waiting_, taken_);
        asked = asked_;
    }
    const auto lost = writer_.take(taken_, takeSamples());
    taken_.clear();
    const std::lock_guard lock(mutex_);
    dropped_.events += lost.events;
    dropped_.samples += lost.samples;
    return asked;
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

Result<void> Recorder::Impl::writeRound(std::uint64_t& answered) {
    auto done = database_ == nullptr ? openStore() : Result<void>();
    if (done) {
        answered = giveToWriter();
        done = writer_.write(*database_);
    }
    if (done) {
        done = trim();
    }
    if (!done) {
        database_.reset();
        trimming_.reset();
    }
    return done;
}

bool Recorder::Impl::somethingWaits() const {
    const std::lock_guard lock(mutex_);
    return waiting_.count() > 0;
}

Result<void> Recorder::Impl::openStore() {
    auto opened = openDatabase(options_.url, Store::Access::write);
    if (!opened) {
        return fail(opened.error());
    }
    const auto opening = opened_ ? Opening::again : Opening::first;
    if (auto there = attend(**opened, options_.server, opening); !there) {
        return there;
    }
    opened_ = true;
    database_ = std::move(*opened);
    return {};
}

/// A part of it: what is told meanwhile is written in between.
Result<void> Recorder::Impl::trim() {
    if (!trimming_ && (!trimmed_ || now() - *trimmed_ >= kTrimEvery)) {
        if (auto closed = closeLostOfOthers(*database_, options_.server); !closed) {
            return closed;
        }
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

void Recorder::Impl::finishRound(const Result<void>& done, std::uint64_t answered) {
    {
        const std::lock_guard lock(mutex_);
        error_ = done ? std::string() : done.error().message;
        answered_ = done ? std::max(answered, answered_) : answered_;
        written_ = writer_.written();
        writer_busy_ = writer_.hasChanges() || writer_.isBusy();
        round_began_.reset();
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
    return round_began_ && now() - *round_began_ > options_.patience;
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
