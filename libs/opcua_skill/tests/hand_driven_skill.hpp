#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "metier/skill/skill.hpp"

namespace metier::opcua_skill::testing {

/// A test's hold on the work of a skill: sees what is asked of it, and answers by hand.
///
/// Threading: any; shared by the test and the skill on the server's thread.
class Hand {
public:
    /// The execution that runs, once it was started.
    skill::ExecutionHandle execution() const;
    /// Parameters of the skill's last start.
    skill::ValueMap snapshot() const;
    /// Whether the work is asked to `what` ("start", "suspend", ...), or the skill to "reset",
    /// within 30 s; each request is returned once.
    bool await(const std::string& what);
    /// From now on Start, or Reset, is refused with this error.
    void refuseStart(Error error);
    void refuseReset(Error error);
    void allowReset();

    /// From now on Check is told as "check", and answered by answerCheck() alone.
    void keepChecks();
    /// The last Check; its answer. The server's thread.
    skill::ArmPositions checkedStarts() const;
    void answerCheck(Result<skill::CheckReport> report);

    void told(const std::string& what);
    void started(skill::ExecutionHandle execution);
    Result<void> prepared(const skill::ValueMap& snapshot);
    Result<void> mayReset() const;
    /// Whether the check is kept.
    bool checked(const skill::ArmPositions& starts, const skill::CheckDone& done);

private:
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::string> reported_;
    skill::ExecutionHandle execution_;
    skill::ValueMap snapshot_;
    Result<void> start_answer_;
    Result<void> reset_answer_;
    bool keeps_checks_ = false;
    skill::ArmPositions starts_;
    skill::CheckDone check_done_;
};

/// A skill that does nothing by itself.
class HandDrivenSkill final : public skill::Skill {
public:
    HandDrivenSkill(skill::SkillDescription description, std::shared_ptr<Hand> hand)
        : description_(std::move(description)), hand_(std::move(hand)) {}

    const skill::SkillDescription& description() const override { return description_; }
    Result<std::unique_ptr<skill::ExecutionWork>> prepare(const skill::ValueMap& snapshot) override;
    Result<void> reset() override;
    void checkFrom(const skill::ArmPositions& starts, const skill::ValueMap& snapshot,
                   skill::CheckDone done) override;

private:
    skill::SkillDescription description_;
    std::shared_ptr<Hand> hand_;  // shared with the test
};

/// JointPtpMoveSkill of an arm with two axes.
skill::SkillDescription jointMoveDescription();
/// CartesianLinearMoveSkill, with a frame, axis bounds and an option.
skill::SkillDescription linearMoveDescription();
/// PositionStreamSkill with its live input.
skill::SkillDescription streamDescription();

}  // namespace metier::opcua_skill::testing
