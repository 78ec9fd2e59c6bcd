#pragma once

#include <list>
#include <map>
#include <memory>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/composition/composition.hpp"
#include "metier/composition/used_skill.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/skill.hpp"

namespace metier::composition {

/// A used skill, and the state of its last execution.
struct BoundSkill final : UsedSkillListener {
    /// The used skill; not null.
    std::unique_ptr<UsedSkill> skill;
    /// Whether it may always be reset; else only if the composed skill halted it.
    bool may_reset = false;
    /// Whether the composed skill halted its last execution.
    bool halted_by_us = false;

    /// Whether a Reset is allowed now.
    bool mayReset() const noexcept { return may_reset || halted_by_us || skill->leftOver(); }
    /// Notes the outcome of a Reset for which nothing waits; it shows at the next Start.
    void onReset(const Result<void>& outcome) override { halted_by_us = halted_by_us && !outcome; }
};

class StepsCheck;

/// Used skills by their aliases.
using BoundSkills = std::map<std::string, BoundSkill, std::less<>>;

/// A skill that runs other skills, as a file says:
///
///     auto composition = compose(*loadDefinition("pick.toml"), descriptions);
///     auto skill = std::make_unique<SequenceSkill>(
///         *composition, std::move(used_skills),
///         SequenceSkill::Host{executor, clock, "pick.PickPlaceSkill~3f09a2"});
///
/// Each execution of a used skill gets the id "ORIGIN/EXECUTION/STEP/COUNT". Suspend, Resume and
/// Halt reach every skill that runs; the whole is at rest once all these are. After a failure none
/// of them is left running. Give its Program restDeadlineOf() as rest_deadline.
/// Threading: the owner's thread, which all used skills report to.
class SequenceSkill final : public skill::Skill {
public:
    /// Surroundings of a composed skill: its thread, its clock and its name.
    struct Host {
        /// Executor of the owner's thread; not null.
        std::shared_ptr<skill::Executor> executor;
        /// Must outlive the skill.
        const Clock& clock;
        /// Names the component, the skill, and this run of the component, so that no id occurs
        /// twice: "pick-server.PickPlaceSkill~3f09a2".
        std::string origin;
    };
    /// \param used_skills one for each alias of the composition; throws std::out_of_range without
    ///                    one
    SequenceSkill(Composition composition,
                  std::map<std::string, std::unique_ptr<UsedSkill>> used_skills, Host host);

    /// Ends the checks that are under way; their answers do not come.
    ~SequenceSkill() override;

    const skill::SkillDescription& description() const override { return composition_.description; }
    /// Steps and bindings; changed by rebind().
    const Definition& definition() const noexcept { return composition_.definition; }
    /// Errors: invalid_state (Halted), resource_unavailable (Running or Suspended),
    ///         connection_lost, with the name of a used skill that every execution needs and that
    ///         cannot begin.
    Result<std::unique_ptr<skill::ExecutionWork>> prepare(const skill::ValueMap& snapshot) override;
    /// Asks the used skills, in the order in which the steps would run them, whether they could be
    /// run; each from where the arms stand after the steps before. What is not known before the run
    /// is a note.
    /// Errors, given to `done`: as prepare(); timeout: not all have answered within 10 s, or
    ///         rebind() has replaced them; resource_unavailable: 16 checks are under way.
    void checkFrom(const skill::ArmPositions& starts, const skill::ValueMap& snapshot,
                   skill::CheckDone done) override;
    /// Whether an execution is running or suspended.
    bool underWay() const noexcept { return work_count_.use_count() > 1; }
    /// Replaces the used skills, from the next execution on.
    /// \param used_skills new ones by alias; after a success, the ones that were used before
    /// Errors: invalid_state (an execution is under way), invalid_argument (a binding does not fit
    /// them), not_found (an alias); then nothing has changed.
    Result<void> rebind(std::map<std::string, std::unique_ptr<UsedSkill>>& used_skills);
    /// Resets the used skills that are Halted, as far as they may be reset.
    /// Errors: those of skills of the same process. An error of a skill of another server is
    /// reported by the next Start.
    Result<void> reset() override;

private:
    Result<void> checkUsable(const std::string& alias) const;
    Result<void> checkNeeded() const;
    Descriptions descriptionsWith(
        const std::map<std::string, std::unique_ptr<UsedSkill>>& used_skills) const;

    Composition composition_;
    BoundSkills used_;
    std::shared_ptr<skill::Executor> executor_;  // shared by what its thread owns
    const Clock& clock_;
    std::string origin_;
    std::vector<std::string> needed_;  // aliases that every execution runs
    std::list<std::unique_ptr<StepsCheck>> checks_;
    // Shared by the work: as many as there are of these, one more than there are work.
    std::shared_ptr<const char> work_count_ = std::make_shared<const char>();
};

/// Deadline to come to rest that a Program of this skill needs: twice rest_time and 1 s, so that
/// used skills that do not come to rest can be halted.
std::chrono::milliseconds restDeadlineOf(const Definition& definition);

}  // namespace metier::composition
