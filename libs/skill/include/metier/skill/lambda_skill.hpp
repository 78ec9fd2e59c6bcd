#pragma once

#include <functional>
#include <memory>

#include "metier/skill/skill.hpp"

namespace metier::skill {

/// The functions of a LambdaSkill. Each is called on the owner's thread and must not block. A
/// function may be left out; its comment says what happens then.
struct SkillFunctions {
    /// Makes further checks at Start. Left out: none.
    std::function<Result<void>(const ValueMap& parameters)> check{};
    /// Begins the work. Left out: the work is finished at once.
    std::function<void(const ValueMap& parameters, const ExecutionHandle&)> start{};
    /// Suspend and resume the work. If one of them is left out, the skill cannot be suspended.
    std::function<Result<void>(const ExecutionHandle&)> suspend{};
    std::function<Result<void>(const ExecutionHandle&)> resume{};
    /// Brakes. Left out: the work counts as at rest at once.
    std::function<void(const ExecutionHandle&)> halt{};
    /// Stops by the device's own stop. Left out: nothing is done.
    std::function<void()> force_stop{};
    /// Clears a fault. Left out: every fault counts as gone.
    std::function<Result<void>()> reset{};
};

/// A skill made of functions.
class LambdaSkill final : public Skill {
public:
    /// description.suspendable is overwritten: true if both suspend and resume are given.
    LambdaSkill(SkillDescription description, SkillFunctions functions);

    const SkillDescription& description() const override { return description_; }
    Result<std::unique_ptr<ExecutionWork>> prepare(const ValueMap& snapshot) override;
    Result<void> reset() override;

private:
    SkillDescription description_;
    SkillFunctions functions_;
};

}  // namespace metier::skill
