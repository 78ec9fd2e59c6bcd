#include "trial.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <csignal>
#include <stdexcept>

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::OwnerLossAction;
using skill::Reason;
using skill::State;
using skill::TransitionEvent;

constexpr double kDistance = 0.6;     // distance of axis 1 [rad]
constexpr double kSpeed = 0.2;        // part of the arm's own
constexpr double kStandstill = 1e-4;  // [rad]
constexpr double kAtTarget = 1e-3;    // [rad]
constexpr auto kLogResolution = 1ms;  // times of the log are cut off to it
constexpr auto kTolerance = 100ms;    // after the end of the lease
constexpr int kLatePerStop = 4;       // threads on the way from a heartbeat to a stop
constexpr auto kLongEnough = 20s;     // for waits without a bound of their own

SteadyTime in(std::chrono::nanoseconds time) {
    return std::chrono::steady_clock::now() + time;
}

double milliseconds(std::chrono::nanoseconds time) {
    return std::chrono::duration<double, std::milli>(time).count();
}

template <typename Answer>
auto orThrow(Answer answer) {
    if (!answer) {
        throw std::runtime_error(answer.error().message);
    }
    return std::move(*answer);
}

void add(std::string& defect, const std::string& more) {
    defect += (defect.empty() ? "" : "; ") + more;
}

bool losesByItsSession(Fault fault) {
    return fault == Fault::closed;
}

bool commandsAgain(Fault fault) {
    return fault == Fault::silent || fault == Fault::stale;
}

/// Expected reaction of a skill whose owner was lost at `stop`, by its next transition.
struct Expected {
    State state;
    Reason reason;
};
std::optional<Expected> expectedOf(const Trial& trial, UtcTime stop, UtcTime next) {
    const bool earlier = next <= stop + kLogResolution;
    switch (trial.at) {
        case AtFault::running:
            if (trial.policy == OwnerLossAction::keep_going) {
                return Expected{State::ready, Reason::finished};
            }
            return Expected{
                trial.policy == OwnerLossAction::halt ? State::halted : State::suspended,
                Reason::owner_lost};
        case AtFault::suspending:
            if (trial.policy == OwnerLossAction::halt && !earlier) {
                return Expected{State::halted, Reason::owner_lost};
            }
            return Expected{State::suspended, Reason::by_client};
        case AtFault::halting:
            return Expected{State::halted, Reason::by_client};
        default:
            return std::nullopt;
    }
}

}  // namespace

DeathRow::DeathRow(const std::vector<std::string>& serve, const std::string& skill, Cable* cable,
                   Bounds bounds)
    : server_(serve),
      cable_(cable),
      bounds_(bounds),
      watcher_(connectTo(server_.url())),
      skill_(openSkill(*watcher_, skill)),
      home_(jointPosition(*watcher_, skill_)) {
    skill_.onTransition([this](const TransitionEvent& event) { transitions_.tryPush(event); });
}

DeathRow::~DeathRow() {
    skill_.onTransition({});
}

/// To and fro, so that no trial needs a way back.
skill::ValueMap DeathRow::nextMove() {
    auto target = jointPosition(*watcher_, skill_);
    target.front() += target.front() > home_.front() ? -kDistance : kDistance;
    return {{"TargetJointPosition", target}, {"SpeedOverride", kSpeed}};
}

link::ChildProcess DeathRow::startCommander(const Trial& trial) {
    move_ = nextMove();
    const auto planned = orThrow(skill_.check(move_));
    if (!planned.possible) {
        throw std::runtime_error(planned.reason);
    }
    duration_ = std::chrono::milliseconds(std::lround(planned.planned_duration * 1000));
    const auto tail = losesByItsSession(trial.fault) ? 0ms : trial.lease;
    const auto delay = (duration_ - tail) * trial.point / kPoints;
    const CommanderOrder order{
        .url = cable_ == nullptr ? server_.url() : Cable::addressOf(server_.url()),
        .skill = skill_.address().name,
        .lease = trial.lease,
        .on_loss = trial.policy,
        .at = trial.at,
        .delay = std::max(delay, 0ms),
        .parameters = move_};
    std::vector<std::string> command{METIER_COMMANDER};
    const auto arguments = argumentsOf(order);
    command.insert(command.end(), arguments.begin(), arguments.end());
    if (cable_ != nullptr) {
        command = cable_->atFarEnd(std::move(command));
    }
    return orThrow(link::ChildProcess::start(command, link::ErrorOutput::with_output));
}

/// The line that has `word`; takes note of the others.
std::string DeathRow::readUntil(link::ChildProcess& commander, const std::string& word,
                                Seen& seen) {
    std::string text;
    const auto deadline = in(kLongEnough);
    for (auto line = commander.readLine(deadline); line; line = commander.readLine(deadline)) {
        const auto space = line->find(' ');
        const auto what = space == std::string::npos ? *line : line->substr(space + 1);
        if (what == word) {
            return what;
        }
        if (what == "beat") {
            const UtcTime sent{std::chrono::microseconds(std::stoll(*line))};
            seen.last_beat = std::max(seen.last_beat.value_or(sent), sent);
        } else if (what.starts_with("accepted ")) {
            seen.accepted.push_back(what);
        } else if (what.starts_with("refused ")) {
            ++seen.refused;
        } else {
            text += *line + "\n";
        }
    }
    if (word.empty()) {
        return {};
    }
    throw std::runtime_error(fmt::format("the commander did not tell '{}': {}", word, text));
}

void DeathRow::strike(const Trial& trial, link::ChildProcess& commander) {
    switch (trial.fault) {
        case Fault::killed:
            commander.signal(SIGKILL);
            break;
        case Fault::stopped:
        case Fault::stale:
            commander.signal(SIGSTOP);
            break;
        case Fault::link_down:
            cable_->unplug();
            break;
        case Fault::dropped:
            cable_->dropEverything();
            break;
        case Fault::one_way:
            cable_->dropWhatComes();
            break;
        case Fault::half_open:
            cable_->dropWhatComes();
            commander.signal(SIGKILL);
            break;
        case Fault::closed:
            commander.signal(kCloseSession);
            break;
        case Fault::silent:
            commander.signal(kFallSilent);
            break;
    }
}

Outcome DeathRow::run(const Trial& trial) {
    Seen seen;
    server_.forgetLosses();
    meter_.takeLongest();
    auto commander = startCommander(trial);
    readUntil(commander, "there", seen);
    strike(trial, commander);
    const auto struck = std::chrono::system_clock::now();
    const auto stop = server_.awaitLoss(in(trial.lease + kLongEnough));
    Outcome outcome;
    if (stop) {
        outcome.after_fault_ms = milliseconds(*stop + kLogResolution - struck);
        judgeEnd(trial, outcome, *stop);
        if (commandsAgain(trial.fault)) {
            judgeStale(trial, commander, seen, outcome);
        }
    } else {
        outcome.defect = "the server did not notice";
    }
    commander.signal(SIGKILL);
    if (cable_ != nullptr) {
        cable_->restore();
    }
    readUntil(commander, {}, seen);
    if (stop) {
        outcome.after_lease_ms =
            milliseconds(*stop + kLogResolution - seen.last_beat.value() - trial.lease);
        outcome.load = meter_.takeLongest();
        judgeTimes(trial, outcome);
    }
    makeReady();
    return outcome;
}

void DeathRow::judgeTimes(const Trial& trial, Outcome& outcome) const {
    const auto wider = bounds_ == Bounds::strict ? 0ns : kLatePerStop * outcome.load;
    const auto bound = milliseconds(kTolerance + wider);
    const auto lease = losesByItsSession(trial.fault) ? 0.0 : milliseconds(trial.lease);
    if (outcome.after_lease_ms > bound) {
        add(outcome.defect, fmt::format("stop {:.1f} ms after the end of the lease, at most {}",
                                        outcome.after_lease_ms, bound));
    }
    if (outcome.after_fault_ms > lease + bound) {
        add(outcome.defect, fmt::format("stop {:.1f} ms after the fault, at most {}",
                                        outcome.after_fault_ms, lease + bound));
    }
}

void DeathRow::judgeEnd(const Trial& trial, Outcome& outcome, UtcTime stop) {
    if (trial.at == AtFault::running || trial.at == AtFault::suspending ||
        trial.at == AtFault::halting) {
        judgeTransition(trial, outcome, stop);
    } else {
        const auto expected = trial.at == AtFault::ready ? State::ready : State::suspended;
        if (const auto state = orThrow(skill_.state()); state != expected) {
            add(outcome.defect,
                fmt::format("{} instead of {}", skill::toString(state), skill::toString(expected)));
        }
    }
    if (auto moved = movedWithin(50ms); !moved.empty()) {
        add(outcome.defect, moved);
    }
}

/// The transition after ReadyToRunning.
void DeathRow::judgeTransition(const Trial& trial, Outcome& outcome, UtcTime stop) {
    const auto started = [](const TransitionEvent& event) {
        return event.number == skill::TransitionNumber::ready_to_running;
    };
    auto event = transitions_.popUntil(in(kLongEnough));
    while (event && !started(*event)) {  // skips those of the trial before
        event = transitions_.popUntil(in(kLongEnough));
    }
    event = transitions_.popUntil(in(kLongEnough));
    if (!event) {
        add(outcome.defect, "no transition followed");
        return;
    }
    if (event->reason == Reason::owner_lost) {
        outcome.standstill_ms = milliseconds(event->time - stop);
    }
    // Before the loss, or while it braked for Suspended: then there is nothing to resume.
    const bool finished_before =
        event->reason == Reason::finished &&
        (event->time <= stop + kLogResolution || trial.policy == OwnerLossAction::suspend) &&
        atTarget();
    const auto expected = expectedOf(trial, stop, event->time);
    if (!finished_before && (event->to != expected->state || event->reason != expected->reason)) {
        add(outcome.defect, fmt::format("{} because of {} ({}) instead of {} because of {}",
                                        skill::toString(event->to), skill::toString(event->reason),
                                        event->reason_text, skill::toString(expected->state),
                                        skill::toString(expected->reason)));
    }
}

bool DeathRow::atTarget() {
    const auto& target = std::get<std::vector<double>>(move_.at("TargetJointPosition"));
    return std::abs(jointPosition(*watcher_, skill_).front() - target.front()) < kAtTarget;
}

/// Nothing that a commander does whose time is over may change anything.
void DeathRow::judgeStale(const Trial& trial, link::ChildProcess& commander, Seen& seen,
                          Outcome& outcome) {
    const auto state = orThrow(skill_.state());
    while (transitions_.popUntil(SteadyTime{})) {
    }
    if (trial.fault == Fault::stale) {
        commander.signal(SIGCONT);
    }
    commander.signal(kCommandAgain);
    readUntil(commander, "tried", seen);
    outcome.refused = seen.refused;
    for (const auto& command : seen.accepted) {
        add(outcome.defect, "a stale commander: " + command);
    }
    if (auto moved = movedWithin(50ms); !moved.empty()) {
        add(outcome.defect, "a stale commander: " + moved);
    }
    if (orThrow(skill_.state()) != state || transitions_.popUntil(SteadyTime{})) {
        add(outcome.defect, "a stale commander changed the state");
    }
}

/// Arms that moved meanwhile; empty if none did.
std::string DeathRow::movedWithin(std::chrono::milliseconds time) {
    const auto first = jointPosition(*watcher_, skill_);
    const auto deadline = in(time);
    while (std::chrono::steady_clock::now() < deadline) {
        const auto now = jointPosition(*watcher_, skill_);
        for (std::size_t axis = 0; axis < now.size(); ++axis) {
            if (std::abs(now[axis] - first[axis]) > kStandstill) {
                return fmt::format("axis {} moves: {:.6f} rad, then {:.6f} rad", axis + 1,
                                   first[axis], now[axis]);
            }
        }
    }
    return {};
}

void DeathRow::makeReady() {
    const auto state = orThrow(skill_.state());
    if (state == State::running) {
        throw std::runtime_error("the skill is still Running");
    }
    if (state != State::ready) {
        const auto reset = skill_.reset();
        if (!reset) {
            throw std::runtime_error("Reset: " + reset.error().message);
        }
    }
    orThrow(skill_.awaitState(State::ready, in(kLongEnough)).map([] { return 0; }));
    while (transitions_.popUntil(SteadyTime{})) {
    }
}

}  // namespace metier::system_tests
