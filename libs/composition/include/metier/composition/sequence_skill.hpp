#pragma once

#include <map>
#include <memory>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/composition/used_skill.hpp"
#include "metier/composition/composition.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/skill.hpp"

namespace metier::composition {

/// A used skill, and what the composed skill knows of its last dealings with it.
struct BoundSkill {
    std::unique_ptr<UsedSkill> skill;
    bool may_reset = false;  ///< in any case; else only if the composed skill halted it
    bool halted_by_us = false;

    bool mayReset() const noexcept { return may_reset || halted_by_us || skill->leftOver(); }
};

using BoundSkills = std::map<std::string, BoundSkill, std::less<>>;

/// A skill whose work is to run other skills, as a file says.
///
/// Its executions give those of the used skills the id "ORIGIN/EXECUTION/STEP/COUNT". Suspend,
/// Resume and Halt reach every skill that runs; at rest it is once these are. A failure leaves none
/// of them running.
/// Threading: the owner's thread, which all used skills report to.
class SequenceSkill final : public skill::Skill {
public:
    /// \param used_skills one for each alias of the composition
    /// \param origin   names the component, the skill, and the life of the component, so that no
    ///                 id comes twice: "pick-server.PickPlaceSkill~3f09a2"
    /// \param clock    must outlive this
    SequenceSkill(Composition composition, std::map<std::string, std::unique_ptr<UsedSkill>> used_skills,
                  std::shared_ptr<skill::Executor> executor, const Clock& clock,
                  std::string origin);
    ~SequenceSkill() override;

    const skill::SkillDescription& description() const override { return composition_.description; }
    const Definition& definition() const noexcept { return composition_.definition; }
    /// Errors: invalid_state, connection_lost, naming a used skill that is certainly needed and
    ///         cannot begin.
    Result<std::unique_ptr<skill::ExecutionWork>> prepare(const skill::ValueMap& snapshot) override;
    bool underWay() const noexcept { return work_count_.use_count() > 1; }
    /// Uses other skills from the next execution on.
    /// \param used_skills by alias; those that were used so far, once this has succeeded
    /// Errors: invalid_state (an execution is under way), invalid_argument (a binding does not fit
    ///         them), not_found (an alias); then nothing has changed.
    Result<void> rebind(std::map<std::string, std::unique_ptr<UsedSkill>>& used_skills);
    /// Resets the used skills that are Halted, as far as they may be.
    /// Errors: what a skill of the same process refuses with. Of others, the next Start tells.
    Result<void> reset() override;

private:
    class Unheard;
    Result<void> checkUsable(const std::string& alias) const;
    Descriptions descriptionsWith(
        const std::map<std::string, std::unique_ptr<UsedSkill>>& used_skills) const;

    Composition composition_;
    BoundSkills used_;
    std::shared_ptr<skill::Executor> executor_;  // shared by what its thread owns
    const Clock& clock_;
    std::string origin_;
    std::vector<std::string> needed_;                          // aliases that every execution runs
    std::map<std::string, std::unique_ptr<Unheard>> unheard_;  // by alias
    // Shared by the work: as many as there are of these, one more than there are work.
    std::shared_ptr<const char> work_count_ = std::make_shared<const char>();
};

/// The deadline to come to rest that a Program of this skill needs: its used skills have theirs
/// before, and time to be halted.
std::chrono::milliseconds restDeadlineOf(const Definition& definition);

}  // namespace metier::composition
