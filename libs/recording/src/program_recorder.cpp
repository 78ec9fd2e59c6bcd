#include "metier/recording/program_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "metier/skill/json.hpp"

namespace metier::recording {

using skill::State;
using skill::TransitionNumber;

namespace {

std::string nameOf(State state) {
    return std::string(toString(state));
}
std::string nameOf(skill::SubState sub_state) {
    return sub_state == skill::SubState::none ? std::string() : std::string(toString(sub_state));
}
std::string nameOf(skill::Reason reason) {
    return reason == skill::Reason::none ? std::string() : std::string(toString(reason));
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

/// What is the same in all records of a Program.
struct ProgramRecorder::Names {
    Place place;
    std::string skill;
};

ProgramRecorder::ProgramRecorder(skill::Program& program, records::Recorder& recorder,
                                 PathSampler* sampler, Place place)
    : program_(program),
      recorder_(recorder),
      sampler_(sampler),
      names_(std::make_shared<const Names>(Names{std::move(place), program.description().name})),
      state_(program.state()) {
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
    key_ = recorder_.begin({.id = execution.id,
                            .parent = execution.parent.id,
                            .parent_server = execution.parent.server,
                            .session = execution.client.session_id,
                            .client_name = execution.client.client_name,
                            .user = execution.client.user_name,
                            .thumbprint = execution.client.thumbprint,
                            .check = check == nullptr ? std::string() : *check,
                            .started = execution.start_time,
                            .state = nameOf(State::running)},
                           [names = names_, parameters = execution.parameters](auto& record) {
                               record.server_name = names->place.server_name;
                               record.skill = names->skill;
                               record.controller = names->place.controller;
                               record.device = names->place.device;
                               record.parameters = skill::jsonOf(*parameters);
                           });
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
        recorder_.transition(key_, {.time = std::chrono::system_clock::now(),
                                    .from = nameOf(state_),
                                    .to = nameOf(state_),
                                    .sub_state = nameOf(sub_state_),
                                    .step = step_});
    }
}

void ProgramRecorder::onProgress(const skill::Value& intermediate) {
    if (key_ != 0) {
        recorder_.intermediate(
            key_, {.time = std::chrono::system_clock::now(), .value = skill::jsonOf(intermediate)});
    }
}

void ProgramRecorder::onStarted(const skill::StartedExecution& child) {
    if (key_ != 0) {
        recorder_.intermediate(
            key_, {.time = std::chrono::system_clock::now(),
                   .value = fmt::format(R"({{"started":{{"id":{},"skill":{},"server_url":{}}}}})",
                                        skill::jsonText(child.id), skill::jsonText(child.skill),
                                        skill::jsonText(child.server_url))});
    }
}

void ProgramRecorder::onTransition(const skill::TransitionEvent& event) {
    state_ = event.to;
    if (key_ == 0) {
        return;
    }
    recorder_.transition(key_, {.time = event.time,
                                .from = nameOf(event.from),
                                .to = nameOf(event.to),
                                .sub_state = nameOf(sub_state_),
                                .step = step_,
                                .reason = nameOf(event.reason),
                                .reason_text = event.reason_text});
    if (endsExecution(event.number)) {
        end(event);
    }
}

void ProgramRecorder::end(const skill::TransitionEvent& event) {
    const auto key = std::exchange(key_, 0);
    const auto missed = sampler_ == nullptr ? 0 : sampler_->end(key);
    const bool finished = event.reason == skill::Reason::finished;
    recorder_.end(key, {.time = event.time,
                        .state = nameOf(event.to),
                        .reason = nameOf(event.reason),
                        .reason_text = event.reason_text,
                        .result = finished ? skill::jsonOf(program_.finalResult()) : std::string(),
                        .missed_cycles = missed});
}

}  // namespace metier::recording
