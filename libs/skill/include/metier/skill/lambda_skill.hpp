#pragma once

#include <functional>
#include <memory>

#include "metier/skill/skill.hpp"

namespace metier::skill {

/// The functions of a LambdaSkill. Each is called on the owner's thread and must not block. A
/// function may be left out; its comment says what happens then. An error, or an exception, has the
/// effect that Skill and ExecutionWork state for it.
///
/// The handle that a function gets belongs to the execution under way; keep a copy to report later,
/// from any thread.
struct SkillFunctions {
    /// Makes further checks at Start, on values whose types and ranges are checked already. Left
    /// out: none. Errors: refuse the Start, or are the reason in the answer of Check.
    std::function<Result<void>(const ValueMap& parameters)> check{};
    /// Begins the work; report its end by ExecutionHandle::finish() or fail(). Left out: the work
    /// is finished at once.
    std::function<void(const ValueMap& parameters, const ExecutionHandle&)> start{};
    /// Asks the work to come to rest; answer by ExecutionHandle::atRest(). If this or `resume` is
    /// left out, the skill cannot be suspended.
    std::function<Result<void>(const ExecutionHandle&)> suspend{};
    /// Continues the work from rest. Errors: the Program stays Suspended.
    std::function<Result<void>(const ExecutionHandle&)> resume{};
    /// Brakes; answer by ExecutionHandle::atRest(). Left out: the work counts as at rest at once.
    std::function<void(const ExecutionHandle&)> halt{};
    /// Stops by the device's own stop; must not throw. Left out: nothing is done.
    std::function<void()> force_stop{};
    /// Clears a fault. Left out: every fault counts as gone. Errors: the Program stays Halted and
    /// shows the text.
    std::function<Result<void>()> reset{};
};

/// A skill made of functions, for skills without state of their own:
///
///     LambdaSkill({.name = "WaveSkill", .type = "WaveSkillType"},
///                 {.start = [&](const ValueMap&, const ExecutionHandle& on) { hand.begin(on); },
///                  .halt = [&](const ExecutionHandle& on) { hand.stop(); on.atRest(); }});
///
/// The work refers to the functions of this skill, so it must not outlive it. Threading: as Skill.
///
/// A complete skill that reports its end from another thread, with a parameter and a result:
///
///     LambdaSkill wave(
///         {.name = "WaveSkill",
///          .type = "WaveSkillType",
///          .parameters = {{.name = "Height", .type = ValueType::number, .unit = kMetre,
///                          .default_value = 0.3}},
///          .results = {{.name = "Waves", .type = ValueType::uint32,
///                       .place = Place::final_result}}},
///         {.start = [&](const ValueMap& values, const ExecutionHandle& on) {
///             hand.wave(std::get<double>(values.at("Height")), [on](std::uint32_t waves) {
///                 on.finish({{"Waves", waves}});
///             });
///         }});
class LambdaSkill final : public Skill {
public:
    /// \param description its `suspendable` is overwritten: true if both suspend and resume are
    ///                    given
    LambdaSkill(SkillDescription description, SkillFunctions functions);

    /// As given, with `suspendable` set.
    const SkillDescription& description() const override { return description_; }
    /// Calls `check`; the work keeps a copy of the values for `start`.
    Result<std::unique_ptr<ExecutionWork>> prepare(const ValueMap& snapshot) override;
    /// Calls `reset`; success without one.
    Result<void> reset() override;

private:
    SkillDescription description_;
    SkillFunctions functions_;
};

}  // namespace metier::skill
