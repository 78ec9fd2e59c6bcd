#include "transition_log.hpp"

#include <utility>

#include "method_values.hpp"
#include "metier/opcua/text.hpp"
#include "metier/opcua_skill/namespaces.hpp"
#include "metier/opcua_skill/values.hpp"

namespace metier::client {
namespace {

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

opcua::Answer<opcua::Subscription> watchTransitions(opcua::Client& client,
                                                    const opcua::NodeId& skill,
                                                    std::shared_ptr<TransitionLog> log) {
    // A server that does not yet list the namespace has no extra event fields: any index will do.
    const auto device = client.namespaceIndex("https://fortiss.org/UA/Device/").value_or(1);
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

void TransitionLog::append(TransitionEvent event) {
    events_.push_back(std::move(event));
    if (events_.size() > kKept) {
        events_.pop_front();
        ++first_number_;
    }
}

void TransitionLog::add(const opcua::EventNotice& notice) {
    using Kind = opcua::EventNotice::Kind;
    const auto event = notice.kind == Kind::event ? eventFrom(notice.fields) : std::nullopt;
    const bool ended = notice.kind == Kind::ended;
    // The end of an interruption follows.
    const bool doubt = !event && !ended && notice.kind != Kind::interrupted;
    Watch watch;
    {
        const std::lock_guard lock(mutex_);
        if (event) {
            append(*event);
        } else if (ended) {
            ended_ = notice.status;
        } else if (doubt) {
            ++doubts_;
        }
        watch = watch_;
    }
    changed_.notify_all();
    if (event && watch.on_transition) {
        watch.on_transition(*event);
    } else if (doubt && watch.on_missed) {
        watch.on_missed();
    } else if (ended && watch.on_ended) {
        watch.on_ended("its events have ended: " + notice.status.name());
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
