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
    : program_(program),
      recorder_(recorder),
      sampler_(sampler),
      place_(std::move(place)),
      state_(program.state()) {
    program_.attach(*this);
}

ProgramRecorder::~ProgramRecorder() {
    program_.detach(*this);
    if (key_ != 0) {
        const skill::TransitionEvent stopped{.to = State::halted,
                                             .time = std::chrono::system_clock::now(),
                                             .reason = skill::Reason::error,
                                             .reason_text = "the server was stopped"};
        recorder_.end(key_, outcomeOf(stopped));
    }
}

void ProgramRecorder::begin(const skill::ExecutionRecord& execution,
                            const skill::TransitionEvent& event) {
    const auto* check = checkOf(execution);
    pack(*execution.parameters, packed_);
    key_ =
        recorder_.begin({.id = execution.id,
                         .server_name = place_.server_name,
                         .skill = program_.description().name,
                         .controller = place_.controller,
                         .device = place_.device,
                         .parent = execution.parent.id,
                         .parent_server = execution.parent.server,
                         .session = execution.client.session_id,
                         .client_name = execution.client.client_name,
                         .user = execution.client.user_name,
                         .thumbprint = execution.client.thumbprint,
                         .parameters = packed_,
                         .check = check == nullptr ? std::string_view() : std::string_view(*check),
                         .started = execution.start_time,
                         .state = nameOf(State::running)},
                        transitionOf(event));
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
        recorder_.transition(
            key_,
            transitionOf({.from = state_, .to = state_, .time = std::chrono::system_clock::now()}));
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

void ProgramRecorder::onTransition(const skill::TransitionEvent& event) {
    state_ = event.to;
    const auto* latest = program_.recentExecution(0);
    if (event.number == TransitionNumber::ready_to_running && latest != nullptr) {
        begin(*latest, event);
    } else if (key_ != 0 && endsExecution(event.number)) {
        const auto outcome = outcomeOf(event);
        recorder_.end(std::exchange(key_, 0), outcome, transitionOf(event));
    } else if (key_ != 0) {
        recorder_.transition(key_, transitionOf(event));
    }
}

/// Valid until the next change of the step.
records::TransitionView ProgramRecorder::transitionOf(const skill::TransitionEvent& event) const {
    return {.time = event.time,
            .from = nameOf(event.from),
            .to = nameOf(event.to),
            .sub_state = nameOf(sub_state_),
            .step = step_,
            .reason = nameOf(event.reason),
            .reason_text = event.reason_text};
}

/// Ends the sampling. Valid until something else is packed.
records::OutcomeView ProgramRecorder::outcomeOf(const skill::TransitionEvent& event) {
    packed_.clear();
    if (event.reason == skill::Reason::finished) {
        pack(program_.finalResult(), packed_);
    }
    return {.time = event.time,
            .state = nameOf(event.to),
            .reason = nameOf(event.reason),
            .reason_text = event.reason_text,
            .result = packed_,
            .missed_cycles = sampler_ == nullptr ? 0 : sampler_->end(key_)};
}

}  // namespace metier::recording
