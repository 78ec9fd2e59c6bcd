#pragma once

#include <chrono>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/composition/used_skill.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/typed_skill.hpp"

namespace metier::composition {

/// An arm that can move together with others.
struct Arm {
    /// Name of the arm in the parameter Arms; unique.
    std::string name{};
    /// CartesianPtpMoveSkill: computes the joint position for a pose; never started.
    std::unique_ptr<composition::UsedSkill> pose_move{};
    /// JointPtpMoveSkill: moves the arm.
    std::unique_ptr<composition::UsedSkill> joint_move{};
    /// Whether this skill halted the last execution.
    bool halted_by_us = false;

    /// Whether it may be reset: only after a halt by this skill.
    bool mayReset() const { return halted_by_us || joint_move->leftOver(); }
};

/// Parameters of the SynchronizedMoveSkill.
struct Parameters {
    /// Names of arms, at least two, none twice.
    std::vector<std::string> arms{};
    /// Target poses, one per arm, base_from_tool of that arm [m, rad].
    std::vector<skill::Frame> target_poses{};
    /// Names of tool frames, one per arm; empty: the flanges.
    std::vector<std::string> tool_frames{};
    /// Least duration [s], 0 to 3600; 0: as short as possible.
    double duration = 0.0;
};

/// Times of the set-points that the arms' controllers got [s]. After a Resume they cover the part
/// since then.
struct Results {
    /// Time between the first set-points of the first and of the last arm [s].
    double skew_at_start = 0.0;
    /// Largest time by which two arms were apart on the way [s].
    double largest_skew = 0.0;
    /// Time between the last set-points of the first and of the last arm [s].
    double skew_at_end = 0.0;
    /// Bound of the error of the skews [s]: the clocks are compared over the network.
    double clock_uncertainty = 0.0;
    /// Time from the first set-point to the last [s].
    double duration = 0.0;
};

/// Settings of the SynchronizedMoveSkill.
struct Options {
    /// Executor of the owner's thread; shared by the objects of that thread.
    std::shared_ptr<skill::Executor> executor;
    /// Clock of this machine; must outlive the skill.
    const Clock& clock;
    /// Names the component, the skill and this run of the component: "both.Synchro...~3f09a2".
    std::string origin;
    /// Time between the end of planning and the begin of the motion [s]; the arms' skills are
    /// started meanwhile.
    std::chrono::duration<double> start_delay{0.5};
};

/// Longest time that an arm may take to come to rest; then the whole is Halted without it.
inline constexpr std::chrono::seconds kRestTime{6};
/// Deadline to come to rest that the Program of this skill needs.
inline constexpr std::chrono::seconds kRestDeadline{2 * kRestTime + std::chrono::seconds(1)};

class SynchronizedCheck;
struct ArmTarget;

/// Moves several arms, each to its pose by a PTP, so that they begin and arrive together.
///
/// Each arm is first asked whether it can reach its pose and how long that takes at least; if one
/// cannot, none moves. All moves take the longest of these times, or Duration if that is longer.
/// They begin at one moment, which each server gets in its own clock's time; the clocks are
/// compared right before. Clocks may differ by any amount, but must not jump during the move. A
/// stop of one arm stops all: if an arm is Halted or lost the others are halted, if somebody
/// suspends one the others are suspended.
///
/// Suspend lets all come to rest. Resume begins anew from there, together again, along the rest of
/// each way; it fails if an arm was moved off its way meanwhile.
/// Threading: the owner's thread, on which all arms report; nothing waits.
class SynchronizedMoveSkill final : public skill::TypedSkill<Parameters, Results> {
public:
    /// \param arms at least two, whose joint moves take Duration and StartTime
    SynchronizedMoveSkill(std::vector<Arm> arms, Options options);
    /// Ends the checks that are under way; their answers do not come.
    ~SynchronizedMoveSkill() override;

    /// Resets those joint moves of the arms that were halted here.
    /// Errors: those of skills of the same process. An error of a skill of another server is
    /// reported by the next Start.
    Result<void> reset() override;

protected:
    /// Errors: invalid_argument (unknown arm, or one twice; counts that differ), connection_lost,
    /// with the arm's name. The arms' states are not checked here: the arms are asked.
    Result<std::unique_ptr<skill::ExecutionWork>> plan(const Parameters& parameters) override;
    /// Asks all arms whether they reach their poses, each from where it stands then.
    /// Errors, given to `done`: as plan(); timeout: not all have answered within 10 s;
    ///         resource_unavailable: 16 checks are under way.
    void assessFrom(const skill::ArmPositions& starts, const Parameters& parameters,
                    skill::CheckDone done) override;

private:
    Result<Arm*> find(const std::string& name);
    Result<std::vector<ArmTarget>> targetsOf(const Parameters& parameters);

    std::vector<Arm> arms_;
    Options options_;
    std::list<std::unique_ptr<SynchronizedCheck>> checks_;
    UsedSkillListener unheard_;  // of a Reset for which nothing waits: it shows at the next Start
};

/// Reason why this joint move does not allow its arm to move together with others; "" if it does.
/// Threads: any; pure.
std::string unfitReason(const skill::SkillDescription& joint_move);

}  // namespace metier::composition
