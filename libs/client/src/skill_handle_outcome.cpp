// Waiting for what a skill does, also over losses of the connection.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "metier/base/random.hpp"
#include "questions.hpp"
#include "skill_handle_impl.hpp"

namespace metier::client {
namespace {

using opcua::Answer;
using opcua::Failure;
using skill::ExecutionRecord;
using skill::State;
using skill::TransitionEvent;
using skill::TransitionNumber;
using std::chrono_literals::operator""ms;
using Delivery = Failure::Delivery;

bool isOver(State state) {
    return state == State::ready || state == State::halted;
}

bool endsExecution(const TransitionEvent& event) {
    return isOver(event.to);
}

bool begins(const TransitionEvent& event) {
    return event.number == TransitionNumber::ready_to_running;
}

Errc errcFor(skill::Reason reason) {
    switch (reason) {
        case skill::Reason::by_client:
            return Errc::cancelled;
        case skill::Reason::device_lost:
            return Errc::connection_lost;
        case skill::Reason::limit_violated:
        case skill::Reason::force_exceeded:
            return Errc::limit_violated;
        default:
            return Errc::device_fault;
    }
}

Failure haltedFailure(const std::string& skill, skill::Reason reason, const std::string& text) {
    return failureOf(errcFor(reason),
                     fmt::format("{} was halted ({}): {}", skill, toString(reason), text));
}

Failure givenUpFailure(const std::string& skill) {
    return failureOf(Errc::cancelled, skill + " was suspended, then reset: it did not finish");
}

// How often the state of a skill is looked at that may send nothing at its end.
constexpr auto kLook = std::chrono::seconds(1);

/// Whether to ask again, once the connection allows it.
bool isForLackOfConnection(const Failure& failure) {
    return failure.delivery != Delivery::answered || failure.code == Errc::connection_lost;
}

}  // namespace

/// The client can ask for an execution that it named even if the answer to Start is lost.
std::string newExecutionId() {
    constexpr std::size_t kDigits = 24;
    return randomHex(kDigits);
}

bool SkillHandle::Impl::isBackAfter(const Failure& failure, SteadyTime deadline) {
    return isForLackOfConnection(failure) && std::chrono::steady_clock::now() < deadline &&
           client.awaitConnected(deadline);
}

std::optional<Failure> SkillHandle::Impl::lostExecution(const std::string& id,
                                                        std::uint64_t since_boot,
                                                        const Failure& answer) const {
    const bool restarted = client.boot() != since_boot;
    if (restarted && (answer.code == Errc::not_found || answer.code == Errc::already_exists)) {
        return failureOf(
            Errc::execution_lost,
            fmt::format("{}: the server was started again and {} execution {}: it was not resumed, "
                        "the motion is over",
                        address.name,
                        answer.code == Errc::not_found ? "does not know" : "knows only the name of",
                        id));
    }
    if (answer.code == Errc::already_exists) {
        return failureOf(Errc::execution_lost,
                         fmt::format("{}: execution {} is over, and the server keeps no record of "
                                     "it any more",
                                     address.name, id));
    }
    return std::nullopt;
}

Answer<ExecutionRecord> SkillHandle::Impl::learn(const std::string& id, std::uint64_t since_boot,
                                                 SteadyTime deadline) {
    for (;;) {
        if (auto connected = client.awaitConnected(deadline); !connected) {
            return tl::unexpected(unknownOutcome(connected.error().message));
        }
        const auto current = refresh();
        auto record = current ? execution(id) : tl::unexpected(current.error());
        if (record) {
            return record;
        }
        if (const auto lost = lostExecution(id, since_boot, record.error())) {
            return tl::unexpected(*lost);
        }
        if (!isBackAfter(record.error(), deadline)) {
            return record;
        }
    }
}

Failure SkillHandle::Impl::unknownOutcome(const std::string& why) const {
    auto failure = failureOf(
        Errc::connection_lost,
        fmt::format("{}: it is unknown what became of the execution: {}", address.name, why));
    failure.delivery = Delivery::unknown;
    return failure;
}

Answer<skill::ValueMap> SkillHandle::Impl::outcomeOf(const ExecutionRecord& record) const {
    if (record.state == State::halted) {
        return tl::unexpected(haltedFailure(address.name, record.reason, record.reason_text));
    }
    if (record.reason != skill::Reason::finished) {
        return tl::unexpected(givenUpFailure(address.name));
    }
    return record.result;
}

Answer<skill::ValueMap> SkillHandle::Impl::outcomeOf(const AwaitedExecution& awaited,
                                                     const TransitionEvent& end,
                                                     SteadyTime deadline) {
    if (end.to == State::halted) {
        return tl::unexpected(haltedFailure(address.name, end.reason, end.reason_text));
    }
    if (end.number == TransitionNumber::suspended_to_ready) {
        return tl::unexpected(givenUpFailure(address.name));
    }
    if (end.number == TransitionNumber::halted_to_ready) {
        return tl::unexpected(
            haltedFailure(address.name, skill::Reason::error, "and reset since by another client"));
    }
    auto values = readResults();
    if (values || !isForLackOfConnection(values.error()) || !nodes.knowsExecutions()) {
        return values;
    }
    const auto record = learn(*awaited.id, awaited.boot, deadline);
    return record ? outcomeOf(*record) : tl::unexpected(record.error());
}

Answer<skill::ValueMap> SkillHandle::Impl::awaitOutcome(AwaitedExecution awaited,
                                                        SteadyTime deadline) {
    if (!nodes.knowsExecutions()) {
        METIER_ASSIGN(const auto end, awaitNamelessEnd(awaited, deadline));
        return outcomeOf(awaited, end, deadline);
    }
    for (;;) {
        const auto found = log->await(awaited.from, deadline, [&](const TransitionEvent& event) {
            return awaited.id ? endsExecution(event) && event.execution_id == *awaited.id
                              : begins(event);
        });
        if (!found) {
            return tl::unexpected(found.error().code == Errc::timeout
                                      ? found.error()
                                      : unknownOutcome(found.error().message));
        }
        if (*found && awaited.id) {
            return outcomeOf(awaited, (*found)->event, deadline);
        }
        if (*found) {
            awaited.id = (*found)->event.execution_id;
            awaited.from.number = (*found)->number + 1;
            continue;
        }
        if (awaited.id.value_or("").empty()) {
            return tl::unexpected(unknownOutcome("transitions may have been missed"));
        }
        awaited.from.doubts = log->mark().doubts;  // before it is asked for
        METIER_ASSIGN(const auto record, learn(*awaited.id, awaited.boot, deadline));
        if (isOver(record.state)) {
            return outcomeOf(record);
        }
    }
}

Answer<State> SkillHandle::Impl::awaitState(SkillHandle& handle, SteadyTime deadline,
                                            const std::function<bool(State)>& wanted) {
    for (;;) {
        // Transitions from here on are waited for; the state read after it covers those before.
        const auto from = log->mark();
        const auto now = handle.state();
        if (!now && !isBackAfter(now.error(), deadline)) {
            return tl::unexpected(now.error());
        }
        if (!now) {
            continue;
        }
        if (wanted(*now)) {
            return *now;
        }
        const auto found = awaitTransition(
            from, deadline, [&wanted](const TransitionEvent& event) { return wanted(event.to); });
        if (!found) {
            return tl::unexpected(found.error());
        }
        if (*found && nodes.knowsExecutions()) {
            return (*found)->event.to;
        }
    }
}

Answer<std::optional<TransitionLog::Found>> SkillHandle::Impl::awaitTransition(
    TransitionLog::Mark from, SteadyTime deadline,
    const std::function<bool(const TransitionEvent&)>& wanted) {
    if (nodes.knowsExecutions()) {
        return log->await(from, deadline, wanted);
    }
    const auto look = std::chrono::steady_clock::now() + kLook;
    auto found = log->await(from, std::min(look, deadline), wanted);
    const bool time_to_look = !found && found.error().code == Errc::timeout && look < deadline;
    return time_to_look ? std::optional<TransitionLog::Found>() : std::move(found);
}

TransitionEvent SkillHandle::Impl::namelessEnd(const ProgramNow& now, TransitionLog::Mark from) {
    const auto ends_so = [&now](const TransitionEvent& event) { return event.to == now.state; };
    const auto patience =
        std::chrono::steady_clock::now() + (now.state == State::halted ? kEventTime : 0ms);
    for (auto found = log->await(from, patience, ends_so); found;
         found = log->await(from, patience, ends_so)) {
        if (*found) {
            auto event = (*found)->event;
            if (event.reason_text.empty()) {
                event.reason_text = reasonText();
            }
            event.number = now.last.value_or(event.number);  // the event may be of a run before
            event.reason =
                now.state == State::halted ? skill::Reason::error : skill::Reason::finished;
            return event;
        }
        from.doubts = log->mark().doubts;
    }
    TransitionEvent end;  // as far as the state shows it
    end.to = now.state;
    end.number = now.last.value_or(now.state == State::halted ? TransitionNumber::running_to_halted
                                                              : TransitionNumber::running_to_ready);
    end.reason = now.state == State::halted ? skill::Reason::error : skill::Reason::finished;
    end.reason_text = reasonText();
    return end;
}

Answer<TransitionEvent> SkillHandle::Impl::awaitNamelessEnd(const AwaitedExecution& awaited,
                                                            SteadyTime deadline) {
    auto from = awaited.from;
    bool begun = awaited.begun;
    for (;;) {
        const auto heard =
            awaitTransition(from, deadline, [](const TransitionEvent& /*any*/) { return true; });
        const bool late = !heard && heard.error().code == Errc::timeout;
        if (!heard && !late) {
            return tl::unexpected(unknownOutcome(heard.error().message));
        }
        from = log->mark();
        const auto now = look();
        if (client.boot() != awaited.boot) {
            return tl::unexpected(startedAgain());
        }
        if (now && isOver(now->state) && begun) {
            return namelessEnd(*now, awaited.from);
        }
        begun = begun || (now && !isOver(now->state));
        if (!now && !isBackAfter(now.error(), deadline)) {
            return tl::unexpected(unknownOutcome(now.error().message));
        }
        if (late) {
            return tl::unexpected(heard.error());
        }
    }
}

Failure SkillHandle::Impl::startedAgain() const {
    return failureOf(
        Errc::execution_lost,
        fmt::format("{}: the server was started again: what ran there was not resumed, "
                    "the motion is over",
                    address.name));
}

Answer<> SkillHandle::awaitState(State wanted, SteadyTime deadline) {
    return impl_->awaitState(*this, deadline, [wanted](State state) { return state == wanted; })
        .map([](State) {});
}

Answer<State> SkillHandle::awaitRest(SteadyTime deadline) {
    return impl_->awaitState(*this, deadline, [](State state) { return state != State::running; });
}

Answer<TransitionEvent> SkillHandle::awaitEnd(SteadyTime deadline) {
    const auto awaited = impl_->own.value_or(
        AwaitedExecution{.from = impl_->log->mark(), .boot = impl_->client.boot(), .begun = false});
    auto from = awaited.from;
    if (!impl_->nodes.knowsExecutions()) {
        auto end = impl_->awaitNamelessEnd(awaited, deadline);
        if (end || end.error().code == Errc::execution_lost) {
            impl_->own.reset();
            impl_->unlock();
        }
        return end;
    }
    for (;;) {
        auto found = impl_->log->await(from, deadline, endsExecution);
        if (!found) {
            const bool away = impl_->client.state() != opcua::Client::State::connected;
            return tl::unexpected(away ? impl_->unknownOutcome("there is no connection")
                                       : found.error());
        }
        if (*found) {
            impl_->own.reset();
            return std::move((*found)->event);
        }
        from.doubts = impl_->log->mark().doubts;
        const auto now = state();
        if (now && impl_->client.boot() != awaited.boot) {
            impl_->own.reset();
            return tl::unexpected(impl_->startedAgain());
        }
        if (now && isOver(*now)) {
            impl_->own.reset();
            TransitionEvent end;  // as far as the state shows it
            end.to = *now;
            end.reason_text = reasonText();
            return end;
        }
        if (!now && !impl_->isBackAfter(now.error(), deadline)) {
            return tl::unexpected(now.error());
        }
    }
}

/// Parameters of a Start that was refused do not count for the next one.
void SkillHandle::takeBack(const skill::ValueMap& parameters, const Failure& refusal) {
    if (refusal.delivery != Delivery::answered) {
        return;  // it may run
    }
    for (const auto& [name, value] : parameters) {
        static_cast<void>(set(name, {}));  // if that fails the session ends, and with it the values
    }
}

Answer<skill::ValueMap> SkillHandle::run(const skill::ValueMap& parameters, SteadyTime deadline) {
    METIER_TRY(impl_->refresh());
    if (!knowsExecutions()) {
        return runWith({.parameters = parameters}, deadline);
    }
    for (const auto& [name, value] : parameters) {
        if (auto written = set(name, value); !written) {
            takeBack(parameters, written.error());
            return tl::unexpected(written.error());
        }
    }
    const AwaitedExecution awaited{impl_->log->mark(), impl_->boot};
    if (auto started = start(); !started) {
        takeBack(parameters, started.error());
        return tl::unexpected(started.error());
    }
    impl_->own.reset();  // waited for here
    return orHalt(impl_->awaitOutcome(awaited, deadline));
}

Answer<skill::ValueMap> SkillHandle::runWith(const skill::StartRequest& request,
                                             SteadyTime deadline) {
    METIER_TRY(impl_->refresh());
    auto named = request;
    if (named.execution_id.empty()) {
        named.execution_id = newExecutionId();
    }
    AwaitedExecution awaited{impl_->log->mark(), impl_->boot};
    auto started = startWith(named);
    if (started) {
        impl_->own.reset();  // waited for here
    }
    const bool unsure = !started && started.error().delivery == Delivery::unknown;
    if (!started && started.error().code == Errc::already_exists) {
        started.error().code = Errc::execution_lost;  // it began, and nothing began now
    }
    if (!started && !(unsure && knowsExecutions())) {
        return tl::unexpected(started.error());
    }
    awaited.id = started ? *started : named.execution_id;
    if (knowsExecutions() &&
        (unsure ||
         !request.execution_id.empty())) {  // it may have been started, or be over, before
        auto record = impl_->learn(*awaited.id, awaited.boot, deadline);
        if (unsure && !record && record.error().code == Errc::not_found) {
            record.error().message = started.error().message + "; it was not: nothing was started";
            record.error().code = Errc::connection_lost;
            record.error().delivery = Delivery::not_sent;
        }
        if (!record) {
            return tl::unexpected(record.error());
        }
        if (isOver(record->state)) {
            return impl_->outcomeOf(*record);
        }
    }
    auto outcome = orHalt(impl_->awaitOutcome(awaited, deadline));
    impl_->unlock();
    return outcome;
}

Answer<skill::ValueMap> SkillHandle::orHalt(Answer<skill::ValueMap> outcome) {
    if (outcome || outcome.error().code != Errc::timeout) {
        return outcome;
    }
    // The work has lost its client's interest: it must not go on alone.
    const auto halted = halt();  // of what cannot be halted, the error says so
    if (halted) {
        return outcome;
    }
    if (isForLackOfConnection(halted.error())) {
        return tl::unexpected(impl_->unknownOutcome(
            "it was not done in its time, and Halt did not reach it: " + halted.error().message));
    }
    outcome.error().message += "; " + halted.error().message;
    return outcome;
}

}  // namespace metier::client
