#include "host/foreign_records.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "metier/composition/wrapped_used_skill.hpp"
#include "metier/skill/json.hpp"
#include "metier/skill/state.hpp"

namespace metier::server {
namespace {

using composition::UsedSkill;
using composition::UsedSkillEnd;
using composition::UsedSkillListener;
using skill::Reason;
using skill::State;

std::string nameOf(State state) {
    return std::string(toString(state));
}
std::string nameOf(Reason reason) {
    return reason == Reason::none ? std::string() : std::string(toString(reason));
}
UtcTime now() {
    return std::chrono::system_clock::now();
}

records::Outcome outcomeOf(const UsedSkillEnd& end) {
    switch (end.kind) {
        case UsedSkillEnd::Kind::finished:
            return {.time = now(),
                    .state = nameOf(State::ready),
                    .reason = nameOf(Reason::finished),
                    .result = skill::jsonOf(end.result)};
        case UsedSkillEnd::Kind::refused:
            return {.time = now(),
                    .state = nameOf(State::halted),
                    .reason = nameOf(Reason::error),
                    .reason_text = "the start was refused: " + end.text};
        case UsedSkillEnd::Kind::halted:
            return {.time = now(),
                    .state = nameOf(State::halted),
                    .reason = nameOf(end.reason),
                    .reason_text = end.text};
        case UsedSkillEnd::Kind::lost:
            break;
    }
    return {.time = now(),
            .state = std::string(records::kLost),
            .reason = std::string(records::kServerLost),
            .reason_text = end.text};
}

class RecordedUsedSkill final : public composition::WrappedUsedSkill {
public:
    RecordedUsedSkill(std::unique_ptr<UsedSkill> used, std::shared_ptr<ForeignRecords> records,
                      ForeignPlace place)
        : WrappedUsedSkill(std::move(used)),
          records_(std::move(records)),
          place_(std::move(place)) {}
    ~RecordedUsedSkill() override { end("nobody waited for its end"); }
    RecordedUsedSkill(const RecordedUsedSkill&) = delete;
    RecordedUsedSkill& operator=(const RecordedUsedSkill&) = delete;

    void begin(skill::StartRequest request, UsedSkillListener& listener) override {
        if (const auto lacks = used().lacks(); !lacks.empty()) {
            beginRecord(request, lacks);
        }
        WrappedUsedSkill::begin(std::move(request), listener);
    }
    void release() override {
        end("nobody waited for its end");
        WrappedUsedSkill::release();
    }

private:
    void beginRecord(const skill::StartRequest& request, const std::string& lacks) {
        key_ = records_->begin({.id = request.execution_id,
                                .server_name = place_.server,
                                .skill = place_.skill,
                                .controller = place_.controller,
                                .parent = request.parent.id,
                                .parent_server = request.parent.server,
                                .parameters = skill::jsonOf(request.parameters),
                                .started = now(),
                                .state = nameOf(State::running)});
        add(State::ready, State::running,
            fmt::format("recorded by the client that started it; {}", lacks));
    }
    void add(State from, State to, std::string text = {}) {
        records_->add(key_, {.time = now(),
                             .from = nameOf(from),
                             .to = nameOf(to),
                             .reason_text = std::move(text)});
    }
    /// Ends a record that is under way with an unknown end.
    void end(std::string text) {
        records_->end(std::exchange(key_, 0),
                      outcomeOf({UsedSkillEnd::Kind::lost, {}, Reason::none, std::move(text)}));
    }

    void onSuspended() override {
        add(State::running, State::suspended);
        WrappedUsedSkill::onSuspended();
    }
    void onResumed() override {
        add(State::suspended, State::running);
        WrappedUsedSkill::onResumed();
    }
    void onEnd(UsedSkillEnd end) override {
        records_->end(std::exchange(key_, 0), outcomeOf(end));
        WrappedUsedSkill::onEnd(std::move(end));
    }

    std::shared_ptr<ForeignRecords> records_;  // shared with the other used skills
    const ForeignPlace place_;
    ForeignRecords::Key key_ = 0;  // of the execution under way; 0: none is recorded
};

}  // namespace

ForeignRecords::Key ForeignRecords::begin(records::ExecutionRow execution) {
    const auto key = recorder_ == nullptr ? Key{0} : recorder_->begin(std::move(execution));
    if (key != 0) {
        under_way_.insert(key);
    }
    return key;
}

void ForeignRecords::add(Key key, records::Transition transition) {
    if (under_way_.contains(key)) {
        recorder_->transition(key, std::move(transition));
    }
}

void ForeignRecords::end(Key key, records::Outcome outcome) {
    if (under_way_.erase(key) != 0) {
        recorder_->end(key, std::move(outcome));
    }
}

void ForeignRecords::letGo() {
    for (const auto key : std::exchange(under_way_, {})) {
        recorder_->end(key, outcomeOf({UsedSkillEnd::Kind::lost,
                                       {},
                                       Reason::none,
                                       "the server that had started it was stopped"}));
    }
    recorder_ = nullptr;
}

std::unique_ptr<composition::UsedSkill> recorded(std::unique_ptr<composition::UsedSkill> used,
                                                 std::shared_ptr<ForeignRecords> records,
                                                 ForeignPlace place) {
    return std::make_unique<RecordedUsedSkill>(std::move(used), std::move(records),
                                               std::move(place));
}

}  // namespace metier::server
