#include "metier/recording/program_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "metier/skill/json.hpp"
#include "packed_values.hpp"

namespace metier::recording {

using skill::State;
using skill::TransitionNumber;

namespace {

std::string_view nameOf(State state) {
    return toString(state);
}
std::string_view nameOf(skill::SubState sub_state) {
    return sub_state == skill::SubState::none ? std::string_view() : toString(sub_state);
}
std::string_view nameOf(skill::Reason reason) {
    return reason == skill::Reason::none ? std::string_view() : toString(reason);
}

std::string jsonOf(const skill::CheckReport& report) {
    return fmt::format(
        R"({{"possible":{},"reason":{},"first_failing_fraction":{},"planned_duration":{}}})",
        report.possible, skill::jsonText(report.reason),
        skill::jsonOf(skill::Value(report.first_failing_fraction)),
        skill::jsonOf(skill::Value(report.planned_duration)));
}

bool endsExecution(TransitionNumber transition) {
    switch (transition) {
        case TransitionNumber::running_to_halted:
        case TransitionNumber::running_to_ready:
        case TransitionNumber::suspended_to_halted:
        case TransitionNumber::suspended_to_ready:
            return true;
        default:
            return false;
    }
}

}  // namespace

ProgramRecorder::ProgramRecorder(skill::Program& program, records::Recorder& recorder,
                                 PathSampler* sampler, Place place)
    : program_(program), recorder_(recorder), sampler_(sampler), state_(program.state()) {
    begun_.server_name = std::move(place.server_name);
    begun_.controller = std::move(place.controller);
    begun_.device = std::move(place.device);
    begun_.skill = program.description().name;
    begun_.state = nameOf(State::running);
    program_.attach(*this);
}

ProgramRecorder::~ProgramRecorder() {
    program_.detach(*this);
    if (key_ != 0) {
        end({.to = State::halted,
             .time = std::chrono::system_clock::now(),
             .reason = skill::Reason::error,
             .reason_text = "the server was stopped"});
    }
}

void ProgramRecorder::onBegin(const skill::ExecutionRecord& execution) {
    const auto* check = checkOf(execution);
    begun_.id = execution.id;
    begun_.parent = execution.parent.id;
    begun_.parent_server = execution.parent.server;
    begun_.session = execution.client.session_id;
    begun_.client_name = execution.client.client_name;
    begun_.user = execution.client.user_name;
    begun_.thumbprint = execution.client.thumbprint;
    begun_.check = check == nullptr ? std::string_view() : std::string_view(*check);
    begun_.started = execution.start_time;
    pack(*execution.parameters, begun_.parameters);
    key_ = recorder_.begin(begun_, packedJson);
    if (sampler_ != nullptr) {
        sampler_->begin(key_);
    }
}

/// What the same session was told of the same values; null: nothing. Defaults need not have been
/// named.
const std::string* ProgramRecorder::checkOf(const skill::ExecutionRecord& execution) const {
    if (checked_.report.empty() || checked_.session != execution.client.session_id) {
        return nullptr;
    }
    const auto& started = *execution.parameters;
    const bool same = std::all_of(
        checked_.parameters.begin(), checked_.parameters.end(), [&](const auto& checked) {
            const auto found = started.find(checked.first);
            return found != started.end() && found->second == checked.second;
        });
    return same ? &checked_.report : nullptr;
}

void ProgramRecorder::onCheck(const skill::Caller& caller, const skill::ValueMap& parameters,
                              const skill::CheckReport& report) {
    checked_ = {caller.session_id, parameters, jsonOf(report)};
}

void ProgramRecorder::onSubState(skill::SubState sub_state, std::string_view step) {
    const bool changed = sub_state != sub_state_ || step != step_;
    sub_state_ = sub_state;
    step_ = step;
    // Of a change of the state the transition tells.
    if (key_ != 0 && changed && program_.state() == state_) {
        tell({.from = state_, .to = state_, .time = std::chrono::system_clock::now()});
    }
}

void ProgramRecorder::onProgress(const skill::Value& intermediate) {
    if (key_ != 0) {
        recorder_.intermediate(
            key_, {.time = std::chrono::system_clock::now(), .value = packed(intermediate)});
    }
}

void ProgramRecorder::onStarted(const skill::StartedExecution& child) {
    if (key_ != 0) {
        recorder_.intermediate(key_, {.time = std::chrono::system_clock::now(),
                                      .value = packedText(fmt::format(
                                          R"({{"started":{{"id":{},"skill":{},"server_url":{}}}}})",
                                          skill::jsonText(child.id), skill::jsonText(child.skill),
                                          skill::jsonText(child.server_url)))});
    }
}

void ProgramRecorder::tell(const skill::TransitionEvent& event) {
    transition_.time = event.time;
    transition_.from = nameOf(event.from);
    transition_.to = nameOf(event.to);
    transition_.sub_state = nameOf(sub_state_);
    transition_.step = step_;
    transition_.reason = nameOf(event.reason);
    transition_.reason_text = event.reason_text;
    recorder_.transition(key_, transition_);
}

void ProgramRecorder::onTransition(const skill::TransitionEvent& event) {
    state_ = event.to;
    if (key_ == 0) {
        return;
    }
    tell(event);
    if (endsExecution(event.number)) {
        end(event);
    }
}

void ProgramRecorder::end(const skill::TransitionEvent& event) {
    const auto key = std::exchange(key_, 0);
    const auto missed = sampler_ == nullptr ? 0 : sampler_->end(key);
    outcome_.time = event.time;
    outcome_.state = nameOf(event.to);
    outcome_.reason = nameOf(event.reason);
    outcome_.reason_text = event.reason_text;
    outcome_.missed_cycles = missed;
    outcome_.result.clear();
    if (event.reason == skill::Reason::finished) {
        pack(program_.finalResult(), outcome_.result);
    }
    recorder_.end(key, outcome_);
}

}  // namespace metier::recording
