#include "metier/records/program_recorder.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "json_text.hpp"
#include "metier/skill/json.hpp"

namespace metier::records {

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
    return dump(
        nlohmann::ordered_json::object({{"possible", report.possible},
                                        {"reason", report.reason},
                                        {"first_failing_fraction", report.first_failing_fraction},
                                        {"planned_duration", report.planned_duration},
                                        {"stopping_time", report.stopping_time},
                                        {"stopping_distance", report.stopping_distance}}));
}

std::string jsonOf(const skill::StartedExecution& child) {
    using nlohmann::ordered_json;
    const auto started = ordered_json::object(
        {{"id", child.id}, {"skill", child.skill}, {"server_url", child.server_url}});
    return dump(ordered_json::object({{"started", started}}));
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

ProgramRecorder::ProgramRecorder(skill::Program& program, Recorder& recorder, PathSampler* sampler,
                                 Place place)
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
        end({.time = std::chrono::system_clock::now(),
             .state = nameOf(State::halted),
             .reason = nameOf(skill::Reason::error),
             .reason_text = "the server was stopped"});
    }
}

void ProgramRecorder::begin(const skill::ExecutionRecord& execution) {
    const auto& client = execution.client;
    key_ = recorder_.begin({.id = execution.id,
                            .server_name = place_.server_name,
                            .skill = program_.description().name,
                            .controller = place_.controller,
                            .device = place_.device,
                            .parent = execution.parent.id,
                            .parent_server = execution.parent.server,
                            .session = client.session_id,
                            .client_name = client.client_name,
                            .user = client.user_name,
                            .thumbprint = client.thumbprint,
                            .parameters = skill::jsonOf(*execution.parameters),
                            .check = checkOf(execution),
                            .started = execution.start_time,
                            .state = nameOf(State::running)});
    if (sampler_ != nullptr) {
        sampler_->begin(key_);
    }
}

void ProgramRecorder::end(Outcome outcome) {
    outcome.missed_cycles = sampler_ == nullptr ? 0 : sampler_->end(key_);
    recorder_.end(std::exchange(key_, 0), std::move(outcome));
}

/// Answer of Check to the same session for the same values; empty: it was not asked. Defaults
/// need not have been named.
std::string ProgramRecorder::checkOf(const skill::ExecutionRecord& execution) const {
    const auto& started = *execution.parameters;
    const bool same =
        checked_.session == execution.client.session_id &&
        std::all_of(checked_.parameters.begin(), checked_.parameters.end(),
                    [&](const auto& checked) {
                        const auto found = started.find(checked.first);
                        return found != started.end() && found->second == checked.second;
                    });
    return same ? checked_.report : std::string();
}

void ProgramRecorder::onCheck(const skill::Caller& caller, const skill::ValueMap& parameters,
                              const skill::CheckReport& report) {
    checked_ = {caller.session_id, parameters, jsonOf(report)};
}

void ProgramRecorder::onSubState(skill::SubState sub_state, std::string_view step) {
    const bool changed = sub_state != sub_state_ || step != step_;
    sub_state_ = sub_state;
    step_ = step;
    // A change of the state has a transition of its own, which follows.
    if (changed && key_ != 0 && program_.state() == state_) {
        add({.from = state_, .to = state_, .time = std::chrono::system_clock::now()});
    }
}

void ProgramRecorder::onProgress(const skill::Value& intermediate) {
    if (key_ != 0) {
        recorder_.intermediate(key_,
                               {std::chrono::system_clock::now(), skill::jsonOf(intermediate)});
    }
}

void ProgramRecorder::onStarted(const skill::StartedExecution& child) {
    recorder_.intermediate(key_, {std::chrono::system_clock::now(), jsonOf(child)});
}

void ProgramRecorder::onTransition(const skill::TransitionEvent& event) {
    state_ = event.to;
    const auto* latest = program_.recentExecution(0);
    if (event.number == TransitionNumber::ready_to_running && latest != nullptr) {
        begin(*latest);
    }
    if (key_ == 0) {
        return;
    }
    add(event);
    if (endsExecution(event.number)) {
        const bool finished = event.reason == skill::Reason::finished;
        end({.time = event.time,
             .state = nameOf(event.to),
             .reason = nameOf(event.reason),
             .reason_text = event.reason_text,
             .result = finished ? skill::jsonOf(program_.finalResult()) : std::string()});
    }
}

void ProgramRecorder::add(const skill::TransitionEvent& event) {
    recorder_.transition(key_, {.time = event.time,
                                .from = nameOf(event.from),
                                .to = nameOf(event.to),
                                .sub_state = nameOf(sub_state_),
                                .step = step_,
                                .reason = nameOf(event.reason),
                                .reason_text = event.reason_text});
}

}  // namespace metier::records
