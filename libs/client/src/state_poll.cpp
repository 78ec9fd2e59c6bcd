#include "state_poll.hpp"

#include <algorithm>

#include "transition_log.hpp"

namespace metier::client {
namespace {

using skill::State;
using namespace std::chrono_literals;

constexpr auto kPauseRunning = 20ms;
constexpr auto kPauseAtRest = 200ms;
constexpr auto kLongestCallback = 5s;

bool isAtRest(State state) {
    return state == State::ready || state == State::halted;
}

/// Time of the newest value; now, if the server sends no times.
UtcTime timeOf(const std::vector<opcua::DataValue>& values) {
    const auto newest = std::max_element(
        values.begin(), values.end(),
        [](const auto& left, const auto& right) { return left.source_time < right.source_time; });
    return newest->source_time != UtcTime{}
               ? newest->source_time
               : std::chrono::time_point_cast<UtcTime::duration>(std::chrono::system_clock::now());
}

}  // namespace

void StatePoll::noteStart() {
    const auto posted = client_.runAfter(0ns, [weak = weak_from_this()] {
        if (const auto self = weak.lock()) {
            ++self->starts_;
            self->ask();
        }
    });
    static_cast<void>(posted);  // a client that is closed has nothing to be asked for
}

void StatePoll::hurry() {
    const auto posted = client_.runAfter(0ns, [weak = weak_from_this()] {
        if (const auto self = weak.lock()) {
            self->ask();
        }
    });
    static_cast<void>(posted);  // as above
}

void StatePoll::stop() {
    stopped_ = true;
    if (caller_ != std::this_thread::get_id() && calling_.try_lock_for(kLongestCallback)) {
        calling_.unlock();
    }
}

bool StatePoll::isOver() const {
    return stopped_ || lost_ || client_.boot() != boot_ ||
           client_.state() == opcua::Client::State::closed;
}

void StatePoll::ask() {
    if (isOver()) {
        return;
    }
    const auto turn = ++turn_;
    const auto sent = client_.readManyAsync(
        programItems(nodes_),
        [weak = weak_from_this(), turn, starts = starts_](const auto& values) {
            const auto self = weak.lock();
            if (!self) {
                return;
            }
            self->answered(values, starts);
            if (turn == self->turn_) {
                const bool runs = self->starts_ > self->ended_ || self->state_ == State::running;
                self->askAfter(runs ? kPauseRunning : kPauseAtRest);
            }
        });
    if (!sent) {
        askAfter(kPauseAtRest);
    }
}

void StatePoll::askAfter(std::chrono::milliseconds pause) {
    if (client_.state() == opcua::Client::State::lost && !lost_) {
        lost_ = true;
        call([this] { log_->doubt(); });  // the last one, as at the end of a subscription
    }
    if (isOver()) {
        return;
    }
    const auto posted = client_.runAfter(pause, [weak = weak_from_this(), turn = turn_] {
        const auto self = weak.lock();
        if (self && turn == self->turn_) {
            self->ask();
        }
    });
    static_cast<void>(posted);  // as in noteStart()
}

void StatePoll::call(const std::function<void()>& work) {
    const std::lock_guard lock(calling_);
    caller_ = std::this_thread::get_id();
    if (!stopped_) {
        work();
    }
    caller_ = std::thread::id();
}

void StatePoll::answered(const opcua::Answer<std::vector<opcua::DataValue>>& values,
                         std::uint64_t starts) {
    const auto now = values ? programNow(*values) : std::nullopt;
    if (now && client_.boot() == boot_) {
        call([&] { take(*now, timeOf(*values), starts); });
    }
}

/// \param starts that were answered before the state was asked for
void StatePoll::take(const ProgramNow& now, UtcTime time, std::uint64_t starts) {
    const bool ended = starts > ended_ && isAtRest(now.state);
    const bool changed = state_ && state_ != now.state;
    if (ended && state_ && isAtRest(*state_)) {
        log_->addState(State::running, time);  // the whole run went by unseen
    }
    state_ = now.state;
    if (ended) {
        ended_ = starts;
    }
    if (!stopped_) {  // by the callback above
        log_->addState(now.state, time);
    }
    if (!stopped_ && (ended || changed)) {
        log_->doubt();
    }
}

}  // namespace metier::client
