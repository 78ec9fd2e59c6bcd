#include "remote_arm/worker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using device::EndCause;
using device::Safety;
using device::SafetyState;

// Period of reading what the server of an arm that stands does not publish by itself.
constexpr auto kIdlePollPeriod = 50ms;
constexpr auto kIdlePause = kIdlePollPeriod;
constexpr auto kBusyPause = 10ms;
// Longest time until the server's safety state follows its Reset.
constexpr auto kResetWait = 2s;
// Longest wait for the reason of a robot that has stopped; it stands meanwhile.
constexpr auto kLongestSilence = 100ms;
// Longest wait for the event of a stream of another maker that is not Running any more: servers
// publish every 50 to 100 ms. Nothing is sent meanwhile.
constexpr auto kLongestEvent = 250ms;
// Longest time until a stream is Ready again after its last set-point.
constexpr auto kLongestEnding = 2s;
// Time without a change of the measured position after which the arm counts as standing, where the
// server does not publish Standstill: the shorter time if it is at its last set-point, the longer
// one elsewhere, since news of its motion may be late.
constexpr auto kStandstillAtTarget = 60ms;
constexpr auto kStandstill = 300ms;
// Largest distance from its last set-point at which an arm counts as there [rad].
constexpr double kAtTarget = 1e-3;
// After a longer pause of this thread it does not catch up set-point by set-point. An arm of
// another maker goes to the newest one at once: what came late together would be one leap.
constexpr std::uint64_t kMostCyclesBehind = 50;
constexpr std::uint64_t kMostCyclesBehindForeign = 1;
// Distance of the measured arm from the last set-point over which it was moved by someone else
// [rad].
constexpr double kMoved = 2e-3;
// Distance of a measured axis from the last set-point over which it does not follow [rad]: a fast
// axis that is a quarter of a second late is nearer.
constexpr double kLost = 0.8;

device::ArmInfo infoOf(const PublishedArm& arm) {
    device::ArmInfo info;
    info.name = arm.name;
    info.axis_names = arm.axis_names;
    info.cycle = std::chrono::duration_cast<std::chrono::nanoseconds>(
        std::chrono::duration<double>(arm.kinematics.cycle_time));
    return info;
}

/// "(Error): protective stop". An event of another maker has no reason: "(Halted): protective
/// stop".
std::string reasonOf(const skill::TransitionEvent& end) {
    return fmt::format("({}): {}",
                       end.reason == skill::Reason::none ? toString(end.to) : toString(end.reason),
                       end.reason_text);
}

}  // namespace

Result<std::unique_ptr<RemoteArm>> RemoteArm::connect(RemoteArmOptions options) {
    // Shared by the thread that waits and the sessions that ring, also late.
    auto wake_up = std::make_shared<WakeUp>();
    METIER_ASSIGN(auto session, StreamSession::open(options, wake_up));
    return std::make_unique<RemoteArmWorker>(std::move(options), std::move(wake_up),
                                             std::move(session));
}

RemoteArmWorker::RemoteArmWorker(RemoteArmOptions options, std::shared_ptr<WakeUp> wake_up,
                                 std::unique_ptr<StreamSession> session)
    : options_(std::move(options)),
      wake_up_(std::move(wake_up)),
      session_(std::move(session)),
      arm_(session_->arm()),
      lacks_(session_->lacks()),
      info_(infoOf(arm_)) {
    observe();
    publish();
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

RemoteArmWorker::~RemoteArmWorker() {
    thread_.request_stop();
    wake_up_->notify();
    thread_ = {};
}

std::optional<RemoteArm::Absence> RemoteArmWorker::absence() const {
    const std::lock_guard lock(mutex_);
    return absence_;
}

Result<void> RemoteArmWorker::attach(std::shared_ptr<device::SetPointSource> source) {
    {
        const std::lock_guard lock(mutex_);
        if (const auto now = safety(); now.state != SafetyState::normal) {
            return fail(Errc::device_fault, now.text);
        }
        if (taken_) {
            return fail(Errc::resource_unavailable, info_.name + ": something moves it already");
        }
        taken_ = true;
        stop_asked_ = false;
        pending_ = std::move(source);
    }
    wake_up_->notify();
    return {};
}

void RemoteArmWorker::nameOwner(std::string application_uri) {
    const std::lock_guard lock(mutex_);
    owner_ = std::move(application_uri);
}

skill::ParentExecution RemoteArmWorker::parent() const {
    const std::lock_guard lock(mutex_);
    return owner_.empty() ? skill::ParentExecution{}
                          : skill::ParentExecution{std::string(source_->execution()), owner_};
}

void RemoteArmWorker::stop() noexcept {
    {
        const std::lock_guard lock(mutex_);
        stop_asked_ = taken_;
    }
    wake_up_->notify();
}

Result<void> RemoteArmWorker::resetFault() {
    const auto now = safety();
    if (now.state == SafetyState::disconnected) {
        return fail(Errc::connection_lost, now.text);
    }
    if (now.state == SafetyState::normal) {
        return {};
    }
    if (auto outcome = resets_.ask()) {
        return std::move(*outcome);
    }
    wake_up_->notify();
    return fail(Errc::timeout, fmt::format("{}: the reset goes on at {}, ask again ({})",
                                           info_.name, options_.url, now.text));
}

void RemoteArmWorker::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        if (session_ == nullptr) {
            reconnect(stop);
        } else {
            observe();
        }
        takeRequests();
        serveSource();
        if (stream_ == Stream::running && !leaves_running_) {
            cycle();
        }
        publish();
        if (session_ != nullptr) {
            session_->poll(isBusy() ? info_.cycle : kIdlePollPeriod);
            wake_up_->wait(stop, nextWake());
        }
    }
    if (stream_ == Stream::running) {
        leaveStream();  // nobody else would end a stream of another maker
    }
    {
        const std::lock_guard lock(mutex_);
        if (pending_ != nullptr) {  // attached meanwhile: it gets its end, too
            source_ = std::exchange(pending_, nullptr);
        }
    }
    letGo(EndCause::disconnected);
}

void RemoteArmWorker::reconnect(const std::stop_token& stop) {
    auto session = StreamSession::open(options_, wake_up_);
    if (!session) {
        wake_up_->wait(stop, std::chrono::steady_clock::now() + options_.retry_interval);
        return;
    }
    if (const auto change = changeOf((*session)->arm(), arm_, options_.url); !change.empty()) {
        session->reset();  // without its stream nothing of it moves
        noteAbsence(Absence{absence_->since, true});
        enter({SafetyState::disconnected, fmt::format("{}: {}", info_.name, change)});
        wake_up_->wait(stop, std::chrono::steady_clock::now() + options_.retry_interval);
        return;
    }
    noteAbsence({});
    session_ = std::move(*session);
    fault_.clear();
    fault_is_limit_ = false;
    halted_by_stop_ = false;
}

void RemoteArmWorker::noteAbsence(std::optional<Absence> absence) {
    const std::lock_guard lock(mutex_);
    absence_ = absence;
}

void RemoteArmWorker::observe() {
    const auto seen = session_->observed();
    observeStream(seen);
    observeArm(seen);
    if (!seen.broken.empty()) {  // before the news of it
        noteAbsence(Absence{std::chrono::steady_clock::now()});
    }
    enter(judge(seen));
    if (!seen.broken.empty()) {
        stream_ = Stream::none;
        letGo(EndCause::disconnected);
        session_.reset();
        if (reset_deadline_) {
            endReset(fail(Errc::connection_lost, safety().text));
        }
        return;
    }
    if (state_.safety != SafetyState::normal) {
        letGo(state_.safety == SafetyState::disconnected ? EndCause::disconnected
                                                         : EndCause::safety);
    }
    answerReset();
}

void RemoteArmWorker::observeStream(const Observed& seen) {
    leaves_running_ = seen.skill.value_or(skill::State::running) != skill::State::running;
    if (stream_ == Stream::none) {
        // Another client runs it: a Halted that follows is not that of our own stop.
        halted_by_stop_ = halted_by_stop_ && seen.skill != skill::State::running;
        return;
    }
    if (const auto end = endOf(seen)) {
        noteEnd(*end);
    } else if (!seen.refused.empty()) {
        fault_ = fmt::format("{}: {}", info_.name, seen.refused);
        leaveStream();
    }
}

/// The state of a skill without named executions may be seen before the event that says why.
std::optional<skill::TransitionEvent> RemoteArmWorker::endOf(const Observed& seen) const {
    if (seen.stream_end || !leaves_running_) {
        return seen.stream_end;
    }
    const auto now = std::chrono::steady_clock::now();
    if (seen.skill != skill::State::ready && seen.words.empty() && !halted_by_stop_ &&
        now - seen.skill_since < kLongestEvent) {
        return std::nullopt;
    }
    if (seen.skill == skill::State::ready && stream_ == Stream::running &&
        now - stream_start_ < kLongestEvent) {
        return std::nullopt;  // its server may show Running a moment after it has answered Start
    }
    skill::TransitionEvent end;
    end.from = skill::State::running;
    end.to = *seen.skill;
    end.reason_text = seen.words.empty() ? "its server does not say why" : seen.words;
    return end;
}

void RemoteArmWorker::noteEnd(const skill::TransitionEvent& end) {
    const bool expected = end.to == skill::State::ready && stream_ == Stream::ending;
    stream_ = Stream::none;
    if (expected && done_) {
        letGo(EndCause::done);
    }
    if (!expected && !halted_by_stop_) {
        fault_ = fmt::format("{}: the position stream ended {}", info_.name, reasonOf(end));
        fault_is_limit_ = end.reason == skill::Reason::limit_violated;
    }
}

void RemoteArmWorker::observeArm(const Observed& seen) {
    const double time = std::chrono::duration<double>(seen.sampled - sampled_).count();
    if (state_.velocity.size() != seen.position.size()) {
        state_.velocity = device::JointArray(seen.position.size());
    } else if (time > 0) {
        for (std::size_t axis = 0; axis < seen.position.size(); ++axis) {
            state_.velocity[axis] = (seen.position[axis] - state_.position[axis]) / time;
        }
    }
    sampled_ = seen.sampled;
    state_.position = seen.position;
    const bool at_target =
        state_.commanded_position.size() == state_.position.size() &&
        device::largestDifference(state_.commanded_position, state_.position) < kAtTarget;
    state_.standstill = judgeStandstill(seen, at_target);
    state_.missed_cycles = seen.missed_cycles;
    if (stream_ == Stream::running && session_->isForeign() && fault_.empty()) {
        checkFollowing();
    }
}

/// An arm of another maker that does not follow is halted: it is blocked, or its arrays have
/// another order than was thought.
void RemoteArmWorker::checkFollowing() {
    for (std::size_t axis = 0; axis < state_.position.size(); ++axis) {
        const auto away = std::abs(state_.position[axis] - state_.commanded_position[axis]);
        if (away > kLost) {
            fault_ = fmt::format("{}: {} is {:.2f} rad away from its set-point, over {} rad",
                                 info_.name, info_.axis_names[axis], away, kLost);
            leaveStream();
            return;
        }
    }
}

bool RemoteArmWorker::judgeStandstill(const Observed& seen, bool at_target) const {
    if (seen.standstill) {
        // While a stream runs, the news may be from before its begin until the arm is at its end.
        return *seen.standstill && (at_target || source_ == nullptr);
    }
    // Between two answers of a server that is asked for the position nothing is known.
    const auto last_known =
        session_->asksForPosition() ? seen.sampled : std::chrono::steady_clock::now();
    const auto unmoved = last_known - seen.moved;
    // Late news of a motion that has come to its end is no motion.
    return unmoved > kStandstill ||
           (at_target && at_own_target_ && (settled_ || unmoved > kStandstillAtTarget));
}

Safety RemoteArmWorker::judge(const Observed& seen) const {
    if (!seen.broken.empty()) {
        return {SafetyState::disconnected, fmt::format("{}: the connection to {} is lost: {}",
                                                       info_.name, options_.url, seen.broken)};
    }
    if (!fault_.empty()) {
        const auto state = seen.safety == SafetyState::normal ? SafetyState::fault : seen.safety;
        return {state, fault_, fault_is_limit_};
    }
    if (seen.safety != SafetyState::normal && !awaitsWords(seen)) {
        const auto text = seen.words.empty() ? std::string(toString(seen.safety)) : seen.words;
        const bool named = text.starts_with(info_.name);
        return {seen.safety, named ? text : fmt::format("{}: {}", info_.name, text)};
    }
    const bool halted = seen.skill == skill::State::halted && stream_ == Stream::none;
    if (halted && !halted_by_stop_) {
        return {SafetyState::fault, fmt::format("{}: its position stream is Halted{}{}", info_.name,
                                                seen.words.empty() ? "" : ": ", seen.words)};
    }
    return {};
}

/// The state of a stopped robot may be seen before the transition that says why. One of another
/// maker need not stand by itself.
bool RemoteArmWorker::awaitsWords(const Observed& seen) const {
    return !session_->isForeign() && seen.words.empty() && state_.safety == SafetyState::normal &&
           std::chrono::steady_clock::now() - seen.safety_since < kLongestSilence;
}

void RemoteArmWorker::enter(Safety safety) {
    state_.safety = safety.state;
    safety_.set(std::move(safety));
    safety_.dispatch();
}

void RemoteArmWorker::publish() {
    const bool moved_by_others =
        state_.commanded_position.size() != state_.position.size() ||
        device::largestDifference(state_.commanded_position, state_.position) > kMoved;
    if (stream_ == Stream::none && moved_by_others) {
        state_.commanded_position = state_.position;
        settled_ = false;
        at_own_target_ = false;
    }
    state_.stamp = std::chrono::steady_clock::now();
    published_.write(state_);
}

void RemoteArmWorker::takeRequests() {
    bool stop_asked = false;
    {
        const std::lock_guard lock(mutex_);
        stop_asked = std::exchange(stop_asked_, false);
        if (pending_ != nullptr) {
            source_ = std::exchange(pending_, nullptr);
            settled_ = false;
        }
    }
    if (resets_.taken()) {
        beginReset();
    }
    if (stop_asked && source_ != nullptr) {
        stopNow();
    }
}

void RemoteArmWorker::beginReset() {
    reset_deadline_ = std::chrono::steady_clock::now() + kResetWait;
    if (session_ == nullptr) {
        endReset(fail(Errc::connection_lost, safety().text));
        return;
    }
    if (auto reset = session_->resetStream(session_->observed().safety != SafetyState::normal);
        !reset) {
        endReset(std::move(reset));
        return;
    }
    fault_.clear();
    fault_is_limit_ = false;
}

/// Answers resetFault(). The server's safety state follows its Reset a moment later; the fault is
/// only gone then.
void RemoteArmWorker::answerReset() {
    if (!reset_deadline_) {
        return;
    }
    if (state_.safety == SafetyState::normal) {
        endReset({});
    } else if (std::chrono::steady_clock::now() > *reset_deadline_) {
        endReset(fail(Errc::device_fault, safety().text));
    }
}

void RemoteArmWorker::endReset(Result<void> outcome) {
    reset_deadline_.reset();
    resets_.answer(std::move(outcome));
}

void RemoteArmWorker::stopNow() {
    if (stream_ == Stream::running && session_ != nullptr) {
        haltStream();
        enterEnding();
    }
    letGo(EndCause::stopped);
}

void RemoteArmWorker::serveSource() {
    if (source_ == nullptr || stream_ == Stream::running) {
        return;
    }
    if (session_ == nullptr) {
        letGo(EndCause::disconnected);
    } else if (stream_ == Stream::none) {
        startStream();
    } else if (std::chrono::steady_clock::now() - ending_since_ > kLongestEnding) {
        fault_ = fmt::format("{}: the position stream did not end", info_.name);
    }
}

void RemoteArmWorker::startStream() {
    if (std::exchange(halted_by_stop_, false)) {
        if (const auto reset = session_->resetHalted(); !reset) {
            fault_ = reset.error().message;
            return;
        }
    }
    if (const auto started = session_->startStream(parent(), state_.commanded_position); !started) {
        fault_ = started.error().message;  // the next look at it ends the motion
        if (session_->observed().skill == skill::State::running) {
            fault_ += "; its position stream is Running, Reset halts it";
        }
        return;
    }
    stream_ = Stream::running;
    leaves_running_ = false;
    stream_start_ = std::chrono::steady_clock::now();
    stream_start_utc_ = std::chrono::system_clock::now();
    sent_ = 0;
}

SteadyTime RemoteArmWorker::nextWake() const {
    if (stream_ == Stream::running && !leaves_running_) {
        return stream_start_ + sent_ * info_.cycle;
    }
    return std::chrono::steady_clock::now() + (isBusy() ? kBusyPause : kIdlePause);
}

/// Whether its end or a deadline is to be seen in time: of a motion, or of a fault.
bool RemoteArmWorker::isBusy() const {
    return source_ != nullptr || stream_ != Stream::none || state_.safety != SafetyState::normal;
}

UtcTime RemoteArmWorker::meantFor() const {
    return stream_start_utc_ + std::chrono::duration_cast<UtcTime::duration>(sent_ * info_.cycle);
}

void RemoteArmWorker::cycle() {
    const auto now = std::chrono::steady_clock::now();
    const auto due = static_cast<std::uint64_t>((now - stream_start_) / info_.cycle) + 1;
    const bool foreign = session_->isForeign();
    if (due > sent_ + (foreign ? kMostCyclesBehindForeign : kMostCyclesBehind)) {
        // The stream paused: it goes on from here; no part of the path is skipped
        sent_ = due - 1;
    }
    if (foreign && session_->isBehind()) {  // it would get all at once what waits on the way
        sent_ = due;
    }
    while (stream_ == Stream::running && sent_ < due) {
        nextSetPoint();
    }
}

void RemoteArmWorker::nextSetPoint() {
    if (source_ == nullptr) {  // it was taken from the arm
        leaveStream();
        return;
    }
    state_.cycle = sent_;
    auto set_point = state_.commanded_position;
    done_ = source_->next(state_, set_point) == device::SetPointSource::Next::done;
    state_.commanded_position = set_point;
    at_own_target_ = true;
    session_->send(set_point, meantFor());
    ++sent_;
    if (done_) {
        finishStream();
    }
}

/// Reports the end to the source once the stream has ended: then the arm is free for the next user.
void RemoteArmWorker::finishStream() {
    enterEnding();
    const auto ending = session_->endStream();
    if (!ending) {
        fault_ = fmt::format("{}: {}", info_.name, ending.error().message);
    } else if (*ending == StreamSession::Ending::reached) {
        stream_ = Stream::none;
        if (const auto seen = session_->observed(); !seen.refused.empty()) {
            fault_ = fmt::format("{}: {}", info_.name, seen.refused);
        }
        observe();  // what came while the end was awaited
        letGo(EndCause::done);
    }
}

/// Leaves a stream before its end. Not every server ends one that is silent.
void RemoteArmWorker::leaveStream() {
    enterEnding();
    if (session_ == nullptr || !session_->isForeign()) {
        return;
    }
    haltStream();
}

void RemoteArmWorker::haltStream() {
    const auto halted = session_->haltStream();
    if (!halted) {
        fault_ = fmt::format("{}: {}", info_.name, halted.error().message);
    }
    halted_by_stop_ = halted.value_or(false);
}

void RemoteArmWorker::enterEnding() {
    stream_ = Stream::ending;
    ending_since_ = std::chrono::steady_clock::now();
}

void RemoteArmWorker::letGo(EndCause cause) {
    done_ = false;
    const auto source = std::exchange(source_, nullptr);
    if (source == nullptr) {
        return;
    }
    settled_ = cause == EndCause::done;
    publish();  // a listener to the end may ask for the state at once
    {
        const std::lock_guard lock(mutex_);
        taken_ = false;
    }
    source->ended(cause, safety());
}

}  // namespace metier::client
