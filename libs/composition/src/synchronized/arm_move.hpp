#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "metier/composition/synchronized_move_skill.hpp"
#include "synchronized/joint_path.hpp"

namespace metier::composition {

/// Target of one arm in a common move.
struct ArmTarget {
    Arm& arm;
    skill::Frame target;
    std::string tool_frame;
};

/// Failure of one arm's part of the move.
struct ArmFailure {
    skill::Reason reason = skill::Reason::error;
    std::string text{};
};

/// Listener to the arms' parts.
class ArmMoveOwner {
public:
    virtual ~ArmMoveOwner() = default;
    /// Something has changed: look at all arms.
    virtual void changed() = 0;
    /// The arm's part cannot go on.
    virtual void failed(ArmFailure failure) = 0;
    /// Somebody else has suspended an arm, which brakes or stands now.
    /// \param why names the arm, and who it was where that is known
    virtual void suspendedByOther(const std::string& why) = 0;
};

/// One arm's part of a synchronized move.
///
/// Threading: the owner's thread.
class ArmMove final : public composition::UsedSkillListener {
public:
    enum class Stage {
        idle,  ///< nothing is under way
        runs,
        resting,   ///< Suspended
        dropping,  ///< its arm's move is being reset
        arrived,
        over,  ///< ended in any other way
    };
    using Done = std::function<void(std::optional<ArmFailure>)>;
    using Setup = ArmTarget;

    ArmMove(Setup setup, ArmMoveOwner& owner) : setup_(std::move(setup)), owner_(owner) {}
    ~ArmMove() override;
    ArmMove(const ArmMove&) = delete;
    ArmMove& operator=(const ArmMove&) = delete;

    Stage stage() const noexcept { return stage_; }
    bool underWay() const noexcept {
        return stage_ == Stage::runs || stage_ == Stage::resting || stage_ == Stage::dropping;
    }
    /// Whether its server has said that it runs.
    bool begun() const { return setup_.arm.joint_move->state() == skill::State::running; }
    const std::string& name() const noexcept { return setup_.arm.name; }

    /// Asks for the way from where the arm stands: its joints, and how long it takes at least.
    /// \param done in a later turn; nothing, or why not
    void ask(Done done);
    void compareClocks(Done done);
    /// After ask() [s].
    double shortestDuration() const noexcept { return shortest_; }
    const composition::ClockOffset& clockOffset() const noexcept { return offset_; }
    bool hasPath() const noexcept { return shortest_ > 0.0; }
    /// Shortest duration of a stop [s] that this arm can make at any time of a motion of that
    /// length, if it slows its planned time down as all arms do. Call it after ask().
    double stopTime(double duration) const noexcept;

    struct Start {
        std::string execution_id;
        std::string parent;  ///< execution that moves the arms
        double duration;     ///< [s]
        double stop_time;    ///< duration of a Suspend, the same for all arms [s]
        UtcTime time;        ///< begin of the motion, by the clock of this machine
    };
    void begin(const Start& start);
    /// The skill that moves the arm.
    const composition::UsedSkill& move() const { return *setup_.arm.joint_move; }
    /// Asks the arm to come to rest; changed() follows.
    void suspend();
    /// Whether the arm's move is Suspended, or was Halted here, so that none can begin.
    bool needsReset() const;
    /// Resets the arm's move; changed() follows.
    void drop();
    void halt();

    /// Start time of an arm that has arrived, by the clock of this machine [s since 1970-01-01
    /// UTC].
    double startTime() const { return localTime("MotionStartTime"); }
    double endTime() const { return localTime("MotionEndTime"); }
    double lateness() const { return number("LargestLateness"); }  ///< [s]

    void onReset(const Result<void>& outcome) override;
    void onStopping(const composition::UsedSkillStop& stop) override;
    void onSuspended() override;
    void onResumed() override;
    void onRefused(skill::Method method, const Error& error) override;
    void onEnd(composition::UsedSkillEnd end) override;

private:
    /// Makes a callback that calls `take` with an answer, as long as this object exists.
    template <typename Answer, typename Take>
    auto whileAlive(Take take) {
        return [alive = alive_, take = std::move(take)](const Result<Answer>& answer) {
            if (*alive) {
                take(answer);
            }
        };
    }
    void askJointMove(Done done);
    std::optional<ArmFailure> checkPossible(const Result<skill::CheckReport>& report) const;
    ArmFailure failureOf(const composition::UsedSkillEnd& end) const;
    ArmFailure haltedFailure(skill::Reason reason, const std::string& text) const;
    ArmFailure failure(const std::string& text, skill::Reason reason = skill::Reason::error) const;
    double number(const std::string& name) const;
    double localTime(const std::string& name) const;

    Setup setup_;
    ArmMoveOwner& owner_;
    Stage stage_ = Stage::idle;
    bool rest_asked_ = false;
    bool halt_asked_ = false;
    JointPath joint_path_;   ///< as first asked for; its end is the target
    double shortest_ = 0.0;  ///< [s]
    double braking_ = 0.0;   ///< braking time at the end of the shortest motion [s]
    composition::ClockOffset offset_;
    skill::ValueMap result_;
    // Answers that come late ask it whether this is still there.
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace metier::composition
