#include "loop.hpp"

#include <open62541/plugin/log.h>

#include <algorithm>
#include <asio/post.hpp>
#include <utility>

#include "loop_interface.hpp"

namespace metier::opcua {

namespace {

constexpr int kHandlersPerTurn = 16;
// Reads from peers for so long, then checks the timers.
constexpr std::chrono::milliseconds kSlice{5};
constexpr std::chrono::milliseconds kSliceForPeers{2};  // for timers that work for peers
constexpr std::chrono::microseconds kLongestCoalescing{100};

}  // namespace

Loop::Loop(EventLoopOptions options) : options_(options), tcp_(reactor_, publisher_, options_) {
    handle_.loop = this;
    handle_.logger = options_.logger;
    handle_.params = &parameters_;
    LoopInterface::fill(handle_);
    LoopInterface::fill(*tcp_.handle(), handle_);
    handle_.eventSources = &tcp_.handle()->eventSource;
}

Loop::~Loop() {
    if (handle_.state == UA_EVENTLOOPSTATE_STARTED) {
        stop();
    }
    while (handle_.state == UA_EVENTLOOPSTATE_STOPPING) {  // bounded: closing waits for no peer
        run(std::chrono::milliseconds::zero());
    }
    release();
}

UA_StatusCode Loop::start() {
    if (handle_.state != UA_EVENTLOOPSTATE_FRESH && handle_.state != UA_EVENTLOOPSTATE_STOPPED) {
        return UA_STATUSCODE_BADINTERNALERROR;
    }
    tcp_.start();
    setState(UA_EVENTLOOPSTATE_STARTED);
    return UA_STATUSCODE_GOOD;
}

void Loop::stop() {
    if (handle_.state != UA_EVENTLOOPSTATE_STARTED) {
        return;
    }
    setState(UA_EVENTLOOPSTATE_STOPPING);
    tcp_.stop();
    checkStopped();
}

UA_StatusCode Loop::run(std::chrono::milliseconds timeout) {
    auto held = lock();
    const bool idle =
        handle_.state == UA_EVENTLOOPSTATE_FRESH || handle_.state == UA_EVENTLOOPSTATE_STOPPED;
    if (idle || running_) {
        UA_LOG_WARNING(options_.logger, UA_LOGCATEGORY_EVENTLOOP, "The event loop cannot run %s",
                       running_ ? "from one of its callbacks" : "before it is started");
        return UA_STATUSCODE_BADINTERNALERROR;
    }
    running_ = true;
    const auto result = guard(options_.logger, [&] { iterate(timeout, held); });
    running_ = false;
    return result;
}

void Loop::iterate(std::chrono::milliseconds timeout,
                   std::unique_lock<std::recursive_mutex>& lock) {
    ++iterations_;
    const auto now = stamp();
    runTimers(now);
    if (tcp_.deliverLeftovers()) {
        // The awaited event of its owner may have come.
        timeout = std::chrono::milliseconds::zero();
    }
    delayed_.run();
    flush();
    reactor_.waitUntil(waitingEnds(now, timeout), lock);
    runReady();
    flush();
    if (handle_.state == UA_EVENTLOOPSTATE_STOPPING) {
        checkStopped();
    }
}

UA_StatusCode Loop::release() {
    if (handle_.state != UA_EVENTLOOPSTATE_FRESH && handle_.state != UA_EVENTLOOPSTATE_STOPPED) {
        return UA_STATUSCODE_BADINTERNALERROR;
    }
    timers_.clear();
    while (!delayed_.empty()) {
        delayed_.run();
    }
    return UA_STATUSCODE_GOOD;
}

TimerId Loop::addTimer(const Timer& timer, SteadyTime first) {
    auto added = timer;
    const auto during = tcp_.currentAccepted();
    added.can_wait = during != 0 && timer.interval > std::chrono::nanoseconds::zero();
    added.id = timers_.add(added, first);
    publisher_.timerAdded(added, during);
    reactor_.wake();
    return added.id;
}

bool Loop::modifyTimer(const Timer& changed, SteadyTime next) {
    reactor_.wake();
    return timers_.modify(changed, next);
}

void Loop::removeTimer(TimerId id) {
    timers_.remove(id);
    publisher_.timerRemoved(id);
}

SteadyTime Loop::nextTimer() const {
    return delayed_.empty() ? timers_.next().value_or(SteadyTime::max())
                            : std::chrono::steady_clock::now();
}

void Loop::addDelayed(UA_DelayedCallback* callback) {
    delayed_.add(callback);
    reactor_.wake();
}

SteadyTime Loop::stamp() {
    const auto now = std::chrono::steady_clock::now();
    last_iteration_.store(now.time_since_epoch().count(), std::memory_order_relaxed);
    return now;
}

void Loop::setState(UA_EventLoopState state) {
    // The interface declares the state const for its readers; only the loop behind it writes it.
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): see above
    const_cast<volatile UA_EventLoopState&>(handle_.state) = state;
}

void Loop::runTimers(SteadyTime now) {
    while (const auto due = timers_.takeDue(now)) {
        publisher_.runTimer(*due);
    }
    const auto end = now + kSliceForPeers;
    auto time = now;
    for (auto due = timers_.takeWaiting(now); due; due = timers_.takeWaiting(now)) {
        publisher_.runTimer(*due);
        time = std::chrono::steady_clock::now();
        if (time >= end) {
            return;
        }
    }
}

SteadyTime Loop::waitingEnds(SteadyTime now, std::chrono::milliseconds timeout) const {
    if (!delayed_.empty() || tcp_.turnsWait() || publisher_.requestedAt()) {
        return now;
    }
    const auto next = std::min(timers_.next().value_or(SteadyTime::max()),
                               publisher_.retryAt().value_or(SteadyTime::max()));
    return std::min(next, now + timeout);
}

/// Handlers do little but note who has something to say; that is heard turn by turn.
void Loop::runReady() {
    const auto end = std::chrono::steady_clock::now() + kSlice;
    auto now = end - kSlice;
    for (bool more = true; more && now < end; now = std::chrono::steady_clock::now()) {
        const bool handled = runHandlers();
        more = tcp_.takeTurn() || handled;
        const auto requested = publisher_.requestedAt();
        if (requested && now - *requested > kLongestCoalescing) {
            flush();
        }
    }
}

/// \return whether there were any
bool Loop::runHandlers() {
    int ran = 0;
    while (ran < kHandlersPerTurn && reactor_.runReady()) {
        ++ran;
    }
    return ran > 0;
}

void Loop::flush() {
    const auto retry = publisher_.retryAt();
    if (publisher_.requestedAt() || (retry && *retry <= std::chrono::steady_clock::now())) {
        publisher_.flush(stamp());
    }
}

void Loop::checkStopped() {
    if (!tcp_.stopped() || !delayed_.empty()) {
        return;
    }
    tcp_.handle()->eventSource.state = UA_EVENTSOURCESTATE_STOPPED;
    setState(UA_EVENTLOOPSTATE_STOPPED);
}

AsioEventLoop::AsioEventLoop(EventLoopOptions options) : loop_(std::make_unique<Loop>(options)) {}

AsioEventLoop::~AsioEventLoop() = default;

UA_EventLoop* AsioEventLoop::handle() noexcept {
    return loop_->handle();
}

void AsioEventLoop::post(std::function<void()> work) {
    asio::post(loop_->reactor_.io(), loop_->reactor_.guarded(std::move(work)));
}

Result<> AsioEventLoop::runOnce(std::chrono::milliseconds timeout) {
    const auto status = loop_->run(timeout);
    if (status == UA_STATUSCODE_GOOD) {
        return {};
    }
    return fail(Errc::internal, std::string("the event loop: ") + UA_StatusCode_name(status));
}

ConnectionId AsioEventLoop::currentConnection() const noexcept {
    return loop_->tcp().currentAccepted();
}

void AsioEventLoop::vouchFor(ConnectionId connection) {
    const auto held = loop_->lock();
    loop_->tcp().vouchFor(connection);
}

void AsioEventLoop::admit(ConnectionId connection) {
    const auto held = loop_->lock();
    loop_->tcp().admit(connection);
}

void AsioEventLoop::dismiss(ConnectionId connection) {
    const auto held = loop_->lock();
    loop_->tcp().dismiss(connection);
}

std::chrono::nanoseconds AsioEventLoop::workOnTurn() const {
    return loop_->tcp().workOnTurn();
}

void AsioEventLoop::flushPublishing(std::span<const ConnectionId> connections) {
    const auto held = loop_->lock();
    loop_->publisher_.request(connections, std::chrono::steady_clock::now());
    loop_->reactor_.wake();
}

void AsioEventLoop::dropOpened() {
    const auto held = loop_->lock();
    loop_->tcp().dropOpened();
}

const TimeHistogram& AsioEventLoop::publishLatency() const noexcept {
    return loop_->publisher_.latency();
}

EventLoopStatistics AsioEventLoop::statistics() const {
    const auto held = loop_->lock();
    auto statistics = loop_->tcp_.statistics();
    statistics.flushes = loop_->publisher_.flushes();
    statistics.fruitless_flushes = loop_->publisher_.fruitless();
    statistics.iterations = loop_->iterations_;
    return statistics;
}

std::vector<ListenAddress> AsioEventLoop::listening() const {
    const auto held = loop_->lock();
    return loop_->tcp().listening();
}

std::string AsioEventLoop::lastNetworkError() const {
    const auto held = loop_->lock();
    return loop_->tcp().lastError();
}

SteadyTime AsioEventLoop::lastIteration() const noexcept {
    const auto last = loop_->last_iteration_.load(std::memory_order_relaxed);
    return SteadyTime(SteadyTime::duration(last));
}

}  // namespace metier::opcua
