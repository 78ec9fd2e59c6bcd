#pragma once

#include <optional>
#include <string>

#include "activity.hpp"
#include "metier/composition/used_skill.hpp"
#include "run.hpp"

namespace metier::composition {

/// A step that runs a used skill.
class CallActivity final : public Activity, private UsedSkillListener {
public:
    using Activity::Activity;
    ~CallActivity() override;

    void start() override;
    void halt() override;
    double progress() const override { return progress_; }

    void suspend();
    bool needsResume() const noexcept { return stage_ == Stage::runs && suspended_; }
    Result<void> resume();
    /// Begins what waited while the Run was held.
    void unpark();
    /// The execution cannot go on: halts it, and fails with `error`.
    void fail(const Error& error);
    void forceStop() noexcept;
    /// Nothing of it moves.
    bool atRest() const noexcept;
    const std::string& path() const noexcept { return path_; }
    /// "step prepare/open: ReleaseGripperSkill"
    std::string describe() const;

private:
    enum class Stage { parked, resetting, runs, ended };

    void onReset(const Result<void>& outcome) override;
    void onStopping(const UsedSkillStop& stop) override;
    void onSuspended() override;
    void onResumed() override;
    void onProgress(const skill::Value& intermediate) override;
    void onRefused(skill::Method method, const Error& error) override;
    void onEnd(UsedSkillEnd end) override;

    void launch();
    void askReset();
    void resetRefused(const Error& error);
    void resetTimePassed();
    void begin();
    void haltUsed();
    void restTimePassed();
    void over(Outcome outcome);
    Outcome outcomeOf(UsedSkillEnd& end);
    StepFailure failure(skill::Reason reason, const std::string& text,
                        StepFailure::Kind kind = StepFailure::Kind::failed) const;
    UsedSkill& used() const { return *run_.used(step_.use).skill; }

    Stage stage_ = Stage::ended;
    bool halting_ = false;
    bool stopping_ = false;  // comes to rest, to be Suspended then
    bool suspended_ = false;
    double progress_ = 0.0;
    SteadyTime begun_{};
    std::string refusal_;                 // text of the last refused Suspend, Halt or Reset
    std::optional<StepFailure> failure_;  // the failure for which it is halted
    skill::Timer rest_timer_;
    SteadyTime reset_begun_{};
    StepTimer reset_limit_{run_};  // time from the first Reset to Ready
    StepTimer reset_pause_{run_};  // time to the next attempt; the activity is parked meanwhile
};

}  // namespace metier::composition
