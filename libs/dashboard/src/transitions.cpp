#include "transitions.hpp"

#include <fmt/format.h>

#include <utility>

#include "metier/opcua/text.hpp"

namespace metier::dashboard {
namespace {

using skill::Reason;
using skill::State;
using skill::TransitionEvent;

std::string subStateOf(const TransitionEvent& event) {
    switch (event.to) {
        case State::running:
            return std::string(toString(skill::SubState::executing));
        case State::halted:
            return std::string(toString(skill::haltedBecause(event.reason)));
        default:
            return {};
    }
}

void apply(const TransitionEvent& event, SkillState& state) {
    state.state = toString(event.to);
    state.sub_state = subStateOf(event);
    state.reason = toString(event.reason);
    state.reason_text = event.reason_text;
    state.execution = event.execution_id;
    state.since = secondsOf(event.time);
    if (event.from != State::suspended && event.to == State::running) {
        state.progress.reset();
        state.step.clear();
    }
}

bool isAlarm(const TransitionEvent& event) {
    return event.reason != Reason::none && event.reason != Reason::finished &&
           event.reason != Reason::by_client;
}

}  // namespace

client::AsyncSkill::OnTransition transitionsTo(Board& board, std::string key) {
    return [&board, key = std::move(key)](const TransitionEvent& event) {
        board.changeSkill(key, [&](SkillState& state) { apply(event, state); });
        if (isAlarm(event)) {
            board.raise({key.substr(0, key.find('/')), event.severity,
                         fmt::format("{}: {}{}{}", key, toString(event.reason),
                                     event.reason_text.empty() ? "" : ": ", event.reason_text),
                         secondsOf(event.time)});
        }
    };
}

std::optional<Alarm> alarmOf(const std::string& server, const opcua::EventNotice& notice) {
    if (notice.kind != opcua::EventNotice::Kind::event || notice.fields.size() != 3) {
        return std::nullopt;
    }
    const auto message = notice.fields[0].as<opcua::LocalizedText>();
    const auto severity = notice.fields[1].as<std::uint16_t>();
    const auto time = notice.fields[2].as<UtcTime>();
    if (!message || !severity || !time) {
        return std::nullopt;
    }
    return Alarm{server, *severity, opcua::sanitise(message->text), secondsOf(*time)};
}

}  // namespace metier::dashboard
