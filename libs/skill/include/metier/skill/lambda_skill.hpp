#pragma once

#include <functional>
#include <memory>

#include "metier/skill/skill.hpp"

namespace metier::skill {

/// What a LambdaSkill does. Each is called on the owner's thread and must not block; one left out
/// does what its comment says.
struct SkillFunctions {
    /// Further checks of Start. Left out: none.
    std::function<Result<void>(const ValueMap& parameters)> check{};
    /// Begins the work. Left out: it is finished at once.
    std::function<void(const ValueMap& parameters, const ExecutionHandle&)> start{};
    /// Left out, or without resume: the skill cannot be suspended.
    std::function<Result<void>(const ExecutionHandle&)> suspend{};
    std::function<Result<void>(const ExecutionHandle&)> resume{};
    /// Brakes. Left out: the work is at rest whenever it is asked.
    std::function<void(const ExecutionHandle&)> halt{};
    /// The device's own stop. Left out: nothing.
    std::function<void()> force_stop{};
    /// Left out: every fault is gone.
    std::function<Result<void>()> reset{};
};

/// A skill made of functions.
class LambdaSkill final : public Skill {
public:
    /// description.suspendable is set by whether suspend and resume are given.
    LambdaSkill(SkillDescription description, SkillFunctions functions);

    const SkillDescription& description() const override { return description_; }
    Result<std::unique_ptr<ExecutionWork>> prepare(const ValueMap& snapshot) override;
    Result<void> reset() override;

private:
    SkillDescription description_;
    SkillFunctions functions_;
};

}  // namespace metier::skill
