#include "metier/server/foreign_records.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "metier/server/user_folders.hpp"
#include "metier/skill/json.hpp"
#include "metier/skill/state.hpp"

namespace metier::server {
namespace {

using composition::UsedSkillEnd;
using skill::Reason;
using skill::State;

std::string nameOf(State state) {
    return std::string(toString(state));
}
std::string nameOf(Reason reason) {
    return reason == Reason::none ? std::string() : std::string(toString(reason));
}
UtcTime timeNow() {
    return std::chrono::system_clock::now();
}

records::Outcome outcomeOf(const UsedSkillEnd& end) {
    switch (end.kind) {
        case UsedSkillEnd::Kind::finished:
            return {.time = timeNow(),
                    .state = nameOf(State::ready),
                    .reason = nameOf(Reason::finished),
                    .result = skill::jsonOf(end.result)};
        case UsedSkillEnd::Kind::refused:
            return {.time = timeNow(),
                    .state = nameOf(State::halted),
                    .reason = nameOf(Reason::error),
                    .reason_text = "the start was refused: " + end.text};
        case UsedSkillEnd::Kind::halted:
            return {.time = timeNow(),
                    .state = nameOf(State::halted),
                    .reason = nameOf(end.reason),
                    .reason_text = end.text};
        case UsedSkillEnd::Kind::lost:
            break;
    }
    return {.time = timeNow(),
            .state = std::string(records::kLost),
            .reason = std::string(records::kServerLost),
            .reason_text = end.text};
}

}  // namespace

Result<std::unique_ptr<records::Recorder>> openForeignStore(
    const std::string& records, const std::string& program,
    std::function<void(const std::string& text)> on_problem) {
    return records::Recorder::create(
        {.url = records,
         .server = fmt::format("urn:{}:metier:{}", hostName(), program),
         .keep = {.age = std::chrono::hours(0), .bytes = 0},
         .on_write_state = [on_problem = std::move(on_problem)](
                               const records::WriteReport& report) { on_problem(report.text); }});
}

ForeignRecords::Key ForeignRecords::begin(records::ExecutionRow execution) {
    const std::lock_guard lock(mutex_);
    if (const auto open = std::exchange(open_, nullptr)) {
        if (auto opened = open()) {
            own_ = std::move(*opened);
            recorder_ = own_.get();
        }
    }
    const auto key = recorder_ == nullptr ? Key{0} : recorder_->begin(std::move(execution));
    if (key != 0) {
        under_way_.insert(key);
    }
    return key;
}

void ForeignRecords::add(Key key, records::Transition transition) {
    const std::lock_guard lock(mutex_);
    if (under_way_.contains(key)) {
        recorder_->transition(key, std::move(transition));
    }
}

void ForeignRecords::end(Key key, records::Outcome outcome) {
    const std::lock_guard lock(mutex_);
    if (under_way_.erase(key) != 0) {
        recorder_->end(key, std::move(outcome));
    }
}

void ForeignRecords::letGo() {
    const std::lock_guard lock(mutex_);
    for (const auto key : std::exchange(under_way_, {})) {
        recorder_->end(key, outcomeOf({UsedSkillEnd::Kind::lost,
                                       {},
                                       Reason::none,
                                       "the server that had started it was stopped"}));
    }
    recorder_ = nullptr;
    open_ = nullptr;
}

ForeignExecution::ForeignExecution(std::shared_ptr<ForeignRecords> records,
                                   const ForeignPlace& place, const skill::StartRequest& request,
                                   const std::string& lacks)
    : records_(std::move(records)),
      key_(records_->begin({.id = request.execution_id,
                            .server_name = place.server,
                            .skill = place.skill,
                            .controller = place.controller,
                            .parent = request.parent.id,
                            .parent_server = request.parent.server,
                            .parameters = skill::jsonOf(request.parameters),
                            .started = timeNow(),
                            .state = nameOf(State::running)})) {
    add(State::ready, State::running,
        fmt::format("recorded by the client that started it; {}", lacks));
}

ForeignExecution::~ForeignExecution() {
    end({UsedSkillEnd::Kind::lost, {}, Reason::none, "nobody waited for its end"});
}

void ForeignExecution::add(State from, State to, std::string text) {
    records_->add(key_, {.time = timeNow(),
                         .from = nameOf(from),
                         .to = nameOf(to),
                         .reason_text = std::move(text)});
}

void ForeignExecution::end(const UsedSkillEnd& end) {
    records_->end(std::exchange(key_, 0), outcomeOf(end));
}

}  // namespace metier::server
