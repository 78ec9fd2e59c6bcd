#include "metier/composition/sequence_skill.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "check/steps_check.hpp"
#include "run.hpp"

namespace metier::composition {

namespace {

using skill::State;
using namespace std::chrono_literals;

// Clients wait longer than that for an answer.
constexpr auto kLongestCheck = 10s;
constexpr std::size_t kMostChecks = 16;

class SequenceWork final : public skill::ExecutionWork {
public:
    SequenceWork(RunSetup setup, const skill::ValueMap& parameters,
                 std::shared_ptr<const char> counted)
        : run_(std::move(setup), parameters), counted_(std::move(counted)) {}

    void start(skill::ExecutionHandle execution) override { run_.start(std::move(execution)); }
    Result<void> suspend() override {
        run_.suspend();
        return {};
    }
    Result<void> resume() override { return run_.resume(); }
    void halt() override { run_.halt(); }
    void forceStop() noexcept override { run_.forceStop(); }

private:
    Run run_;
    std::shared_ptr<const char> counted_;
};

/// Whether an execution that comes by a step comes by all steps in it.
bool runsAllSteps(const Step& step) {
    switch (step.kind) {
        case StepKind::sequence:
            return true;
        case StepKind::parallel:
            return step.wait_for == WaitFor::all;
        case StepKind::loop:
            return !step.condition;
        default:
            return false;
    }
}

/// The aliases of the calls that every execution comes by.
void collectNeeded(const std::vector<Step>& steps, std::vector<std::string>& aliases) {
    for (const auto& step : steps) {
        if (step.kind == StepKind::call) {
            if (std::find(aliases.begin(), aliases.end(), step.use) == aliases.end()) {
                aliases.push_back(step.use);
            }
        } else if (runsAllSteps(step)) {
            collectNeeded(step.steps, aliases);
        }
    }
}

}  // namespace

SequenceSkill::SequenceSkill(Composition composition,
                             std::map<std::string, std::unique_ptr<UsedSkill>> used_skills,
                             Host host)
    : composition_(std::move(composition)),
      executor_(std::move(host.executor)),
      clock_(host.clock),
      origin_(std::move(host.origin)) {
    for (const auto& use : composition_.definition.uses) {
        auto& bound = used_[use.alias];
        bound.skill = std::move(used_skills.at(use.alias));
        bound.may_reset = use.reset;
    }
    collectNeeded(composition_.definition.root.steps, needed_);
}

SequenceSkill::~SequenceSkill() = default;

Result<void> SequenceSkill::checkUsable(const std::string& alias) const {
    const auto& bound = used_.find(alias)->second;
    const auto& used = *bound.skill;
    if (const auto available = used.available(); !available) {
        return fail(available.error().code,
                    fmt::format("{} ({}) cannot be reached: {}", used.name(), alias,
                                available.error().message));
    }
    if (used.state() == State::halted && !bound.mayReset()) {
        return fail(Errc::invalid_state,
                    fmt::format("{} ({}) is Halted: {}; reset it, or write reset = true in "
                                "[uses.{}]",
                                used.name(), alias, used.reasonText(), alias));
    }
    if (used.state() == State::running || used.state() == State::suspended) {
        return fail(Errc::resource_unavailable, fmt::format("{} ({}) is {}", used.name(), alias,
                                                            skill::toString(used.state())));
    }
    return {};
}

Result<void> SequenceSkill::checkNeeded() const {
    for (const auto& alias : needed_) {
        METIER_TRY(checkUsable(alias));
    }
    return {};
}

void SequenceSkill::checkFrom(const skill::ArmPositions& starts, const skill::ValueMap& snapshot,
                              skill::CheckDone done) {
    std::erase_if(checks_, [](const auto& check) { return check->over(); });
    auto usable = checkNeeded();
    if (usable && checks_.size() >= kMostChecks) {
        usable = fail(Errc::resource_unavailable,
                      fmt::format("{} checks are under way", checks_.size()));
    }
    if (!usable) {
        done(fail(usable.error()));
        return;
    }
    checks_.push_back(std::make_unique<StepsCheck>(
        StepsCheck::Setup{composition_, used_, *executor_}, snapshot, starts));
    checks_.back()->start(kLongestCheck, std::move(done));
}

Result<std::unique_ptr<skill::ExecutionWork>> SequenceSkill::prepare(
    const skill::ValueMap& snapshot) {
    METIER_TRY(checkNeeded());
    return std::make_unique<SequenceWork>(RunSetup{composition_, used_, executor_, clock_, origin_},
                                          snapshot, work_count_);
}

Descriptions SequenceSkill::descriptionsWith(
    const std::map<std::string, std::unique_ptr<UsedSkill>>& used_skills) const {
    Descriptions descriptions;
    for (const auto& [alias, bound] : used_) {
        const auto other = used_skills.find(alias);
        const auto& used = other == used_skills.end() ? *bound.skill : *other->second;
        descriptions.emplace(alias, used.description());
    }
    return descriptions;
}

Result<void> SequenceSkill::rebind(std::map<std::string, std::unique_ptr<UsedSkill>>& used_skills) {
    if (underWay()) {
        return fail(Errc::invalid_state, "an execution is under way");
    }
    for (const auto& [alias, used] : used_skills) {
        if (used_.find(alias) == used_.end()) {
            return fail(Errc::not_found, fmt::format("no use {}", alias));
        }
    }
    METIER_ASSIGN(auto composed, compose(composition_.given, descriptionsWith(used_skills)));
    for (const auto& check : checks_) {
        check->giveUp("the skills that it uses were replaced meanwhile");
    }
    checks_.clear();
    composition_ = std::move(composed);
    for (auto& [alias, used] : used_skills) {
        auto& bound = used_.find(alias)->second;
        std::swap(bound.skill, used);
        bound.halted_by_us = false;
    }
    return {};
}

Result<void> SequenceSkill::reset() {
    for (auto& [alias, bound] : used_) {
        auto& used = *bound.skill;
        if (!bound.mayReset() || !used.available() || used.state() != State::halted) {
            continue;
        }
        if (const auto asked = used.reset(bound); !asked) {
            return fail(asked.error().code, fmt::format("{} ({}) refused Reset: {}", used.name(),
                                                        alias, asked.error().message));
        }
    }
    return {};
}

std::chrono::milliseconds restDeadlineOf(const Definition& definition) {
    constexpr std::chrono::milliseconds kSpare{1'000};
    return std::chrono::duration_cast<std::chrono::milliseconds>(2 * definition.rest_time) + kSpare;
}

}  // namespace metier::composition
