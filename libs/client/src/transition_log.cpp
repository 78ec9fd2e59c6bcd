#include "transition_log.hpp"

#include <utility>

#include "method_values.hpp"
#include "metier/opcua/text.hpp"
#include "metier/opcua_skill/namespaces.hpp"
#include "metier/opcua_skill/values.hpp"

namespace metier::client {
namespace {

using skill::State;
using skill::TransitionEvent;

constexpr std::size_t kKept = 1000;

/// The fields that watchTransitions() asks for, in its order.
enum EventField : std::size_t {
    kNumber,
    kTime,
    kMessage,
    kSeverity,
    kIntermediate,
    kExecutionId,
    kReason,
    kReasonText,
    kFieldCount,
};

template <typename T>
T fieldOr(const std::vector<opcua::Value>& fields, EventField field, T fallback) {
    return fields[field].as<T>().value_or(std::move(fallback));
}

std::optional<TransitionEvent> eventFrom(const std::vector<opcua::Value>& fields) {
    if (fields.size() != kFieldCount) {
        return std::nullopt;
    }
    const auto number = fieldOr<std::uint32_t>(fields, kNumber, 0);
    if (number < 1 || number > 9) {
        return std::nullopt;
    }
    TransitionEvent event;
    event.number = static_cast<skill::TransitionNumber>(number);
    event.from = skill::fromState(event.number);
    event.to = skill::toState(event.number);
    event.time = fieldOr(fields, kTime, UtcTime{});
    event.message = opcua::sanitise(fieldOr(fields, kMessage, opcua::LocalizedText{}).text);
    event.severity = fieldOr<std::uint16_t>(fields, kSeverity, 0);
    event.execution_id = opcua::sanitise(fieldOr(fields, kExecutionId, std::string{}));
    event.reason = reasonFrom(fieldOr<std::int32_t>(fields, kReason, 0));
    event.reason_text = opcua::sanitise(fieldOr(fields, kReasonText, std::string{}));
    const auto& intermediate = fields[kIntermediate];
    event.intermediate_result =
        opcua_skill::fromOpcua(intermediate, opcua_skill::valueTypeOf(intermediate))
            .value_or(skill::Value{});
    return event;
}

/// The fields that watchNameless() asks for, in its order: every TransitionEventType has them
/// (OPC 10000-16), but for the last.
enum NamelessField : std::size_t {
    kTransitionId,
    kTransitionName,
    kFromId,
    kFromName,
    kToId,
    kToName,
    kNamelessTime,
    kNamelessMessage,
    kNamelessSeverity,
    kNamelessIntermediate,
    kNamelessCount,
};

opcua::EventFilter namelessFilter() {
    return {.fields = {{{0, "Transition"}, {0, "Id"}},
                       {{0, "Transition"}},
                       {{0, "FromState"}, {0, "Id"}},
                       {{0, "FromState"}},
                       {{0, "ToState"}, {0, "Id"}},
                       {{0, "ToState"}},
                       {{0, "Time"}},
                       {{0, "Message"}},
                       {{0, "Severity"}},
                       {{0, "IntermediateResult"}}},
            .of_type = opcua::ids::kTransitionEventType};
}

std::optional<skill::TransitionNumber> namelessNumber(const std::vector<opcua::Value>& fields) {
    const opcua::Value none;
    if (const auto named = transitionFrom({fields[kTransitionId], none, fields[kTransitionName]})) {
        return named;
    }
    const auto from = stateFrom({fields[kFromId], none, fields[kFromName]});
    const auto to = stateFrom({fields[kToId], none, fields[kToName]});
    return from && to ? transitionBetween(*from, *to) : std::nullopt;
}

/// An event without Reason: the server's message says why.
std::optional<TransitionEvent> namelessEventFrom(std::vector<opcua::Value> fields) {
    if (fields.size() + 1 == kNamelessCount) {
        fields.emplace_back();
    }
    const auto number = fields.size() == kNamelessCount ? namelessNumber(fields) : std::nullopt;
    if (!number) {
        return std::nullopt;
    }
    TransitionEvent event;
    event.number = *number;
    event.from = skill::fromState(*number);
    event.to = skill::toState(*number);
    event.time = fields[kNamelessTime].as<UtcTime>().value_or(UtcTime{});
    const auto message = fields[kNamelessMessage].as<opcua::LocalizedText>();
    event.message = message ? opcua::sanitise(message->text) : "";
    event.reason_text = event.message;
    event.severity = fields[kNamelessSeverity].as<std::uint16_t>().value_or(0);
    const auto& intermediate = fields[kNamelessIntermediate];
    event.intermediate_result =
        opcua_skill::fromOpcua(intermediate, opcua_skill::valueTypeOf(intermediate))
            .value_or(skill::Value{});
    return event;
}

/// \return nothing for any other notice: the transition that follows says the same
std::optional<skill::StoppingEvent> stoppingFrom(const opcua::EventNotice& notice) {
    constexpr std::size_t count = 5;  // number of the fields that watchStopping() asks for
    const auto& fields = notice.fields;
    if (notice.kind != opcua::EventNotice::Kind::event || fields.size() != count) {
        return std::nullopt;
    }
    const auto state = fields[2].as<std::uint32_t>().value_or(0);
    const bool suspends = state == static_cast<std::uint32_t>(skill::State::suspended);
    return skill::StoppingEvent{
        .time = fields[0].as<UtcTime>().value_or(UtcTime{}),
        .execution_id = opcua::sanitise(fields[1].as<std::string>().value_or("")),
        .to = suspends ? skill::State::suspended : skill::State::halted,
        .reason = reasonFrom(fields[3].as<std::int32_t>().value_or(0)),
        .reason_text = opcua::sanitise(fields[4].as<std::string>().value_or(""))};
}

}  // namespace

namespace {

opcua::Answer<opcua::Subscription> watchNamed(opcua::Client& client, const opcua::NodeId& skill,
                                              std::shared_ptr<TransitionLog> log) {
    // A server that does not yet list the namespace has no extra event fields: any index will do.
    const auto device = client.namespaceIndex(opcua_skill::kDeviceUri).value_or(1);
    const opcua::EventFilter filter{.fields = {{{0, "Transition"}, {0, "Number"}},
                                               {{0, "Time"}},
                                               {{0, "Message"}},
                                               {{0, "Severity"}},
                                               {{0, "IntermediateResult"}},
                                               {{device, "ExecutionId"}},
                                               {{device, "Reason"}},
                                               {{device, "ReasonText"}}},
                                    .of_type = opcua::ids::kProgramTransitionEventType};
    return client.subscribeEvents(
        skill, filter,
        [log = std::move(log)](const opcua::EventNotice& notice) { log->add(notice); });
}

/// \return nothing, if the server refuses
/// Errors: those of the connection.
opcua::Answer<std::optional<opcua::Subscription>> unlessRefused(
    opcua::Answer<opcua::Subscription> subscription) {
    if (subscription) {
        return std::optional(std::move(*subscription));
    }
    if (subscription.error().delivery == opcua::Failure::Delivery::answered) {
        return std::optional<opcua::Subscription>();
    }
    return tl::unexpected(std::move(subscription.error()));
}

/// \return nothing, if the skill sends no events
opcua::Answer<std::optional<opcua::Subscription>> watchNameless(
    opcua::Client& client, const opcua::NodeId& skill, std::shared_ptr<TransitionLog> log) {
    constexpr std::uint8_t subscribable = 1;
    const auto notifier = client.read(skill, opcua::AttributeId::event_notifier);
    if (!notifier || (notifier->as<std::uint8_t>().value_or(0) & subscribable) == 0) {
        return std::optional<opcua::Subscription>();
    }
    const auto subscribe = [&](opcua::EventFilter filter) {
        return unlessRefused(client.subscribeEvents(
            skill, std::move(filter),
            [log](const opcua::EventNotice& notice) { log->addNameless(notice); }));
    };
    METIER_ASSIGN(auto subscription, subscribe(namelessFilter()));
    if (!subscription) {  // for lack of Programs in its types
        auto filter = namelessFilter();
        filter.fields.pop_back();
        METIER_ASSIGN(subscription, subscribe(std::move(filter)));
    }
    return subscription;
}

enum class Adds { doubts, states };

/// \return nothing, if the server refuses
opcua::Answer<std::optional<opcua::Subscription>> watchState(opcua::Client& client,
                                                             const ProgramNodes& nodes,
                                                             std::shared_ptr<TransitionLog> log,
                                                             Adds adds) {
    constexpr std::uint32_t queue = 100;
    const auto& node = !nodes.state_id.isNull()       ? nodes.state_id
                       : !nodes.state_number.isNull() ? nodes.state_number
                                                      : nodes.state;
    return unlessRefused(client.subscribeData(
        node, {.sampling_interval = std::chrono::milliseconds(0), .queue_size = queue},
        [log = std::move(log), adds](const opcua::DataValue& data) {
            const auto state = stateFrom({data.value, data.value, data.value});
            if (state && adds == Adds::states) {
                log->addState(*state, data.source_time);
            }
            log->doubt();
        }));
}

}  // namespace

opcua::Answer<TransitionWatch> watchTransitions(opcua::Client& client, const opcua::NodeId& skill,
                                                const SkillNodes& nodes,
                                                std::shared_ptr<TransitionLog> log) {
    TransitionWatch watch;
    if (nodes.knowsExecutions()) {
        METIER_ASSIGN(auto named, watchNamed(client, skill, std::move(log)));
        watch.subscriptions.push_back(std::move(named));
        watch.events = true;
        return watch;
    }
    METIER_ASSIGN(auto events, watchNameless(client, skill, log));
    METIER_ASSIGN(auto state,
                  watchState(client, nodes.program, log, events ? Adds::doubts : Adds::states));
    watch.events = events.has_value();
    for (auto* subscription : {&events, &state}) {
        if (*subscription) {
            watch.subscriptions.push_back(std::move(**subscription));
        }
    }
    if (watch.subscriptions.empty()) {
        log->forgetState();
        watch.polling =
            StatePolling(std::make_shared<StatePoll>(client, nodes.program, std::move(log)));
    }
    return watch;
}

opcua::Answer<opcua::Subscription> watchStopping(
    opcua::Client& client, const opcua::NodeId& skill,
    std::function<void(const skill::StoppingEvent&)> on_stopping) {
    if (!on_stopping) {
        return opcua::Subscription();
    }
    METIER_ASSIGN(const auto metier, client.namespaceIndex(opcua_skill::kMetierUri));
    const opcua::EventFilter filter{
        .fields = {{{0, "Time"}},
                   {{metier, "ExecutionId"}},
                   {{metier, "StateAtRest"}},
                   {{metier, "Reason"}},
                   {{metier, "ReasonText"}}},
        .of_type = opcua::NodeId(metier, opcua_skill::kStoppingEventTypeId)};
    return client.subscribeEvents(
        skill, filter, [on_stopping = std::move(on_stopping)](const opcua::EventNotice& notice) {
            if (const auto event = stoppingFrom(notice)) {
                on_stopping(*event);
            }
        });
}

namespace {

/// State that a Program must pass next to come from one state to another.
State nextOnTheWay(State from, State to) {
    if (transitionBetween(from, to)) {
        return to;
    }
    return from == State::halted ? State::ready : State::running;
}

}  // namespace

void TransitionLog::append(TransitionEvent event) {
    events_.push_back(std::move(event));
    if (events_.size() > kKept) {
        events_.pop_front();
        ++first_number_;
    }
}

void TransitionLog::add(const opcua::EventNotice& notice) {
    using Kind = opcua::EventNotice::Kind;
    News news;
    if (notice.kind == Kind::event) {
        news.event = eventFrom(notice.fields);
    }
    if (notice.kind == Kind::ended) {
        news.ended = notice.status;
    }
    // The end of an interruption follows.
    news.doubt = !news.event && !news.ended && notice.kind != Kind::interrupted;
    take(news);
}

void TransitionLog::addNameless(const opcua::EventNotice& notice) {
    using Kind = opcua::EventNotice::Kind;
    News news{.doubt = true};  // also at the end: the state can still be read
    if (notice.kind == Kind::event) {
        news.event = namelessEventFrom(notice.fields);
    }
    take(news);
}

void TransitionLog::addState(State state, UtcTime time) {
    if (!state_) {
        state_ = state;
    }
    while (state_ != state) {
        TransitionEvent event;
        event.from = *state_;
        event.to = nextOnTheWay(*state_, state);
        event.number = transitionBetween(event.from, event.to).value();
        event.time = time;
        state_ = event.to;
        take({.event = event});
    }
}

std::string TransitionLog::textOfLast(State state) const {
    const std::lock_guard lock(mutex_);
    return events_.empty() || events_.back().to != state ? "" : events_.back().reason_text;
}

void TransitionLog::doubt() {
    take({.doubt = true});
}

void TransitionLog::take(const News& news) {
    Watch watch;
    {
        const std::lock_guard lock(mutex_);
        if (news.event) {
            append(*news.event);
        }
        if (news.ended) {
            ended_ = news.ended;
        }
        if (news.doubt) {
            ++doubts_;
        }
        watch = watch_;
    }
    changed_.notify_all();
    if (news.event && watch.on_transition) {
        watch.on_transition(*news.event);
    }
    if (news.doubt && watch.on_missed) {
        watch.on_missed();
    }
    if (news.ended && watch.on_ended) {
        watch.on_ended("its events have ended: " + news.ended->name());
    }
}

void TransitionLog::watch(Watch watch) {
    const std::lock_guard lock(mutex_);
    watch_ = std::move(watch);
}

TransitionLog::Mark TransitionLog::mark() const {
    const std::lock_guard lock(mutex_);
    return {first_number_ + events_.size(), doubts_};
}

std::optional<TransitionLog::Found> TransitionLog::findFrom(
    std::uint64_t from, const std::function<bool(const TransitionEvent&)>& wanted) const {
    for (auto number = std::max(from, first_number_); number < first_number_ + events_.size();
         ++number) {
        const auto& event = events_[number - first_number_];
        if (wanted(event)) {
            return Found{number, event};
        }
    }
    return std::nullopt;
}

opcua::Answer<std::optional<TransitionLog::Found>> TransitionLog::await(
    Mark from, SteadyTime deadline, const std::function<bool(const TransitionEvent&)>& wanted) {
    std::optional<Found> found;
    std::unique_lock lock(mutex_);
    const bool told = changed_.wait_until(lock, deadline, [&] {
        found = findFrom(from.number, wanted);
        return found || ended_ || doubts_ > from.doubts;
    });
    if (found || (told && !ended_)) {
        return found;
    }
    return opcua::failed(ended_.value_or(opcua::status::kBadTimeout), "waiting for a transition");
}

}  // namespace metier::client
