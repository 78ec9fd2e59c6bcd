#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/composition/used_skill.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/typed_skill.hpp"

namespace metier::composition {

/// An arm that can be moved together with others.
struct Arm {
    std::string name{};
    /// CartesianPtpMoveSkill: asked for the joints of a pose, never started.
    std::unique_ptr<composition::UsedSkill> pose_move{};
    /// JointPtpMoveSkill: moves the arm.
    std::unique_ptr<composition::UsedSkill> joint_move{};
    bool halted_by_us = false;  ///< the last execution was halted here

    /// Only what was halted here is reset here.
    bool mayReset() const { return halted_by_us || joint_move->leftOver(); }
};

struct Parameters {
    std::vector<std::string> arms{};           ///< names, at least two, none twice
    std::vector<skill::Frame> target_poses{};  ///< one per arm, base_from_tool
    std::vector<std::string> tool_frames{};    ///< one per arm; empty: the flanges
    double duration = 0.0;                     ///< least duration [s]
};

/// All by the set-points that the arms' controllers were given [s]. After a Resume they tell of the
/// part since then.
struct Results {
    double skew_at_start = 0.0;      ///< between the first ones of the first and of the last arm
    double largest_skew = 0.0;       ///< no two arms were further apart on the way
    double skew_at_end = 0.0;        ///< as skew_at_start, of the last ones
    double clock_uncertainty = 0.0;  ///< the skews may be wrong by that much
    double duration = 0.0;           ///< from the first one to the last one
};

struct Options {
    std::shared_ptr<skill::Executor> executor;  ///< shared by what its thread owns
    const Clock& clock;                         ///< must outlive the skill
    /// Names the component, the skill and the life of the component: "both.Synchro...~3f09a2".
    std::string origin;
    /// From the moment at which all is known until the arms begin: they are told and made ready
    /// meanwhile [s].
    std::chrono::duration<double> start_delay{0.5};
};

/// How long an arm may take to come to rest before the whole is Halted without it.
inline constexpr std::chrono::seconds kRestTime{6};
/// The deadline to come to rest that the Program of this skill needs.
inline constexpr std::chrono::seconds kRestDeadline{2 * kRestTime + std::chrono::seconds(1)};

/// Moves several arms, each to its pose by a PTP, so that they begin and arrive together.
///
/// Each arm is first asked whether it can get there and how long that takes at least; if one
/// cannot, none moves. The slowest one's time, or Duration, is what all of them take. They begin at
/// one moment, each told it by its own server's clock, which is compared right before: clocks may
/// differ by any amount, but must not jump during the move. What stops one stops all: if an arm is
/// Halted or lost the others are halted, if somebody suspends one the others are suspended.
///
/// Suspend lets all come to rest; Resume begins anew from there, again together, along what is left
/// of each way; it fails if an arm was moved off its way meanwhile.
/// Threading: the owner's thread, which all arms report to; nothing waits.
class SynchronizedMoveSkill final : public skill::TypedSkill<Parameters, Results> {
public:
    /// \param arms at least two, whose joint moves take Duration and StartTime
    SynchronizedMoveSkill(std::vector<Arm> arms, Options options);
    ~SynchronizedMoveSkill() override;

    /// Resets the arms' moves that were halted here.
    /// Errors: what a skill of the same process refuses with. Of others, the next Start tells.
    Result<void> reset() override;

protected:
    /// Errors: invalid_argument (unknown arm, or one twice; counts that differ), connection_lost,
    ///         naming the arm. What state the arms are in, they are asked.
    Result<std::unique_ptr<skill::ExecutionWork>> plan(const Parameters& parameters) override;

private:
    class Unheard;
    Result<Arm*> find(const std::string& name);

    std::vector<Arm> arms_;
    Options options_;
    std::unique_ptr<Unheard> unheard_;
};

/// Why an arm cannot be moved together with others by this skill of it; "" if it can.
std::string unfitReason(const skill::SkillDescription& joint_move);

}  // namespace metier::composition
