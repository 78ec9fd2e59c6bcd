#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "metier/composition/used_skill.hpp"

namespace metier::composition::testing {

/// A used skill whose every word is the test's.
class ScriptedUsedSkill final : public UsedSkill {
public:
    ScriptedUsedSkill(std::string name, skill::SkillDescription description)
        : name_(std::move(name)), description_(std::move(description)) {}

    const std::string& name() const override { return name_; }
    const skill::SkillDescription& description() const override { return description_; }
    std::string lacks() const override { return lacks_text; }
    Result<void> available() const override { return reachable; }
    skill::State state() const override { return state_now; }
    std::string reasonText() const override { return reason_text; }
    Result<void> reset(UsedSkillListener& to) override {
        calls.emplace_back("reset");
        listener = &to;
        return reset_answer;
    }
    std::string serverUrl() const override { return url; }
    bool runsOthers() const override { return runs_others; }
    void check(const skill::CheckRequest& question, skill::CheckDone done) override {
        if (on_check) {
            done(on_check(question));
            return;
        }
        calls.emplace_back("check");
        checked = question.parameters;
        check_done = std::move(done);
    }
    void compareClocks(std::function<void(Result<ClockOffset>)> done) override {
        calls.emplace_back("compareClocks");
        clocks_done = std::move(done);
    }
    void begin(skill::StartRequest asked, UsedSkillListener& to) override {
        calls.emplace_back("begin");
        request = std::move(asked);
        listener = &to;
        state_now = skill::State::running;
    }
    Result<void> suspend() override {
        calls.emplace_back("suspend");
        return suspend_answer;
    }
    Result<void> resume() override {
        calls.emplace_back("resume");
        return resume_answer;
    }
    void halt() override { calls.emplace_back("halt"); }
    void release() override { listener = nullptr; }

    // Events of its execution.
    void finish(skill::ValueMap result = {}) {
        state_now = skill::State::ready;
        listener->onEnd({UsedSkillEnd::Kind::finished, std::move(result)});
    }
    void halted(skill::Reason reason = skill::Reason::by_client, std::string text = {}) {
        state_now = skill::State::halted;
        reason_text = text;
        listener->onEnd({UsedSkillEnd::Kind::halted, {}, reason, std::move(text)});
    }
    void refused(std::string text) {
        state_now = skill::State::ready;
        listener->onEnd({UsedSkillEnd::Kind::refused, {}, skill::Reason::error, std::move(text)});
    }
    void stops(skill::State to, std::string text = "by somebody") {
        listener->onStopping({to, skill::Reason::by_client, std::move(text)});
    }
    void suspended() {
        state_now = skill::State::suspended;
        listener->onSuspended();
    }
    void resumed() {
        state_now = skill::State::running;
        listener->onResumed();
    }
    void wasReset(const Result<void>& outcome = {}) {
        state_now = outcome ? skill::State::ready : skill::State::halted;
        listener->onReset(outcome);
    }
    /// Calls since the last time.
    std::vector<std::string> heard() { return std::exchange(calls, {}); }
    bool runs() const { return listener != nullptr; }

    std::string lacks_text{};
    Result<void> reachable{};
    skill::State state_now = skill::State::ready;
    std::string reason_text{};
    Result<void> reset_answer{};
    Result<void> suspend_answer{};
    Result<void> resume_answer{};
    std::vector<std::string> calls{};
    skill::StartRequest request{};
    std::string url{};
    bool runs_others = false;
    /// Answers each Check at once; none: the test does, by check_done.
    std::function<Result<skill::CheckReport>(const skill::CheckRequest&)> on_check{};
    skill::ValueMap checked{};
    skill::CheckDone check_done{};
    std::function<void(Result<ClockOffset>)> clocks_done{};
    UsedSkillListener* listener = nullptr;

private:
    std::string name_;
    skill::SkillDescription description_;
};

}  // namespace metier::composition::testing
