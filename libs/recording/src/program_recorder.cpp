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
        R"({{"possible":{},"reason":{},"first_failing_fraction":{},"planned_duration":{},"stopping_time":{},"stopping_distance":{}}})",
        report.possible, skill::jsonText(report.reason),
        skill::jsonOf(skill::Value(report.first_failing_fraction)),
        skill::jsonOf(skill::Value(report.planned_duration)),
        skill::jsonOf(skill::Value(report.stopping_time)),
        skill::jsonOf(skill::Value(report.stopping_distance)));
}

/// Fewer than the history of a Program keeps, since one more may be under way.
constexpr std::size_t kMostUntold = skill::ExecutionHistory::kMost / 2;

records::TransitionView beginOf(const skill::ExecutionRecord& execution) {
    return {.time = execution.start_time,
            .from = nameOf(State::ready),
            .to = nameOf(State::running),
            .sub_state = nameOf(skill::SubState::executing)};
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
    tellUntold();
    if (key_ != 0) {
        recorder_.end(key_, {.time = std::chrono::system_clock::now(),
                             .state = nameOf(State::halted),
                             .reason = nameOf(skill::Reason::error),
                             .reason_text = "the server was stopped",
                             .missed_cycles = endSampling()});
    }
}

/// Of an arm's execution samples follow; what Check said may be something else later.
void ProgramRecorder::begin(const skill::ExecutionRecord& execution) {
    const auto* check = checkOf(execution);
    if (check != nullptr || sampler_ != nullptr) {
        tellUntold();
        tellBegin(execution, check);
        return;
    }
    if (untold_ == kMostUntold) {
        tellUntold();
    }
    begun_ = true;
    tellLater();
}

void ProgramRecorder::tellBegin(const skill::ExecutionRecord& execution, const std::string* check) {
    key_ = recorder_.begin(viewOf(execution, check), beginOf(execution));
    if (sampler_ != nullptr) {
        sampler_->begin(key_);
    }
}

/// Of an execution that went from Ready to Running and out of it.
void ProgramRecorder::tellWhole(const skill::ExecutionRecord& execution) {
    const auto sub_state = execution.state == State::halted ? skill::haltedBecause(execution.reason)
                                                            : skill::SubState::ready_not_configured;
    recorder_.record({.execution = viewOf(execution, nullptr),
                      .first = beginOf(execution),
                      .last = {.time = execution.end_time,
                               .from = nameOf(State::running),
                               .to = nameOf(execution.state),
                               .sub_state = nameOf(sub_state),
                               .reason = nameOf(execution.reason),
                               .reason_text = execution.reason_text},
                      .outcome = {.time = execution.end_time,
                                  .state = nameOf(execution.state),
                                  .reason = nameOf(execution.reason),
                                  .reason_text = execution.reason_text,
                                  .result = packedResult(execution.reason, execution.result)}});
}

/// Valid until the next.
/// \param check null: nothing was asked before
records::ExecutionView ProgramRecorder::viewOf(const skill::ExecutionRecord& execution,
                                               const std::string* check) {
    if (execution.parameters != parameters_) {
        parameters_ = execution.parameters;
        pack(*parameters_, packed_parameters_);
    }
    return {.id = execution.id,
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
            .parameters = packed_parameters_,
            .check = check == nullptr ? std::string_view() : std::string_view(*check),
            .started = execution.start_time,
            .state = nameOf(State::running)};
}

void ProgramRecorder::tellUntold() {
    later_.reset();
    // The history's latest is the one that is under way, if one is.
    const std::size_t newer = state_ == State::running || state_ == State::suspended ? 1 : 0;
    for (; untold_ > 0; --untold_) {
        if (const auto* execution = program_.recentExecution(untold_ - 1 + newer)) {
            tellWhole(*execution);
        }
    }
    if (const auto* latest = program_.recentExecution(0); std::exchange(begun_, false) && latest) {
        tellBegin(*latest, nullptr);
    }
}

void ProgramRecorder::tellLater() {
    if (!later_) {
        later_ = program_.executor().after(kLater, [this] { tellUntold(); });
    }
}

bool ProgramRecorder::isUnderWay() const {
    return begun_ || key_ != 0;
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
    // Of a change of the state the transition tells.
    const bool told = changed && isUnderWay() && program_.state() == state_;
    if (told) {
        tellUntold();
    }
    sub_state_ = sub_state;
    step_ = step;
    if (told) {
        recorder_.transition(
            key_,
            transitionOf({.from = state_, .to = state_, .time = std::chrono::system_clock::now()}));
    }
}

void ProgramRecorder::onProgress(const skill::Value& intermediate) {
    if (isUnderWay()) {
        tellUntold();
        recorder_.intermediate(
            key_, {.time = std::chrono::system_clock::now(), .value = packed(intermediate)});
    }
}

void ProgramRecorder::onStarted(const skill::StartedExecution& child) {
    if (isUnderWay()) {
        tellUntold();
        recorder_.intermediate(key_, {.time = std::chrono::system_clock::now(),
                                      .value = packedText(fmt::format(
                                          R"({{"started":{{"id":{},"skill":{},"server_url":{}}}}})",
                                          skill::jsonText(child.id), skill::jsonText(child.skill),
                                          skill::jsonText(child.server_url)))});
    }
}

void ProgramRecorder::onTransition(const skill::TransitionEvent& event) {
    const auto* latest = program_.recentExecution(0);
    const bool ends = endsExecution(event.number);
    if (!ends && isUnderWay()) {
        tellUntold();
    }
    state_ = event.to;
    if (event.number == TransitionNumber::ready_to_running && latest != nullptr) {
        begin(*latest);
    } else if (ends && std::exchange(begun_, false)) {
        ++untold_;
    } else if (ends && key_ != 0) {
        const auto missed_cycles = endSampling();
        recorder_.end(std::exchange(key_, 0),
                      {.time = event.time,
                       .state = nameOf(event.to),
                       .reason = nameOf(event.reason),
                       .reason_text = event.reason_text,
                       .result = packedResult(event.reason, program_.finalResult()),
                       .missed_cycles = missed_cycles},
                      transitionOf(event));
    } else if (key_ != 0) {
        recorder_.transition(key_, transitionOf(event));
    }
}

std::uint64_t ProgramRecorder::endSampling() {
    return sampler_ == nullptr ? 0 : sampler_->end(key_);
}

/// Empty unless it finished. Valid until the next.
std::string_view ProgramRecorder::packedResult(skill::Reason reason,
                                               const skill::ValueMap& result) {
    if (reason != skill::Reason::finished) {
        return {};
    }
    pack(result, packed_result_);
    return packed_result_;
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

}  // namespace metier::recording
