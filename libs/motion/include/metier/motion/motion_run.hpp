#pragma once

#include <optional>

#include "metier/motion/pace_brake.hpp"
#include "metier/motion/trajectory.hpp"

namespace metier::motion {

/// Rule for cycles that come late.
struct LateCyclePolicy {
    /// Period of the controller [s]; 0: no step is too late.
    Seconds cycle{0};
    /// Number of cycles that one step may skip; the motion stops if more are missing.
    int most_skipped = 4;
};

/// Time and way that a motion needs to come to rest.
struct StoppingEstimate {
    /// Time until the set-points stand [s].
    Seconds time{0};
    /// Distance of the tool frame's origin now from its place at rest [m].
    double distance = 0;
};

/// Runs a trajectory: gives the set-point of each cycle, brakes and goes on along the path.
///
///     MotionRun run(*planner.lin(request));
///     while (!run.finished()) { send(run.next(cycle).position); }  // once per cycle
///
/// Stop, halt, resume and override act along the path only: the arm never leaves it. The time to
/// rest after halt() depends on the robot's own limits, never on those of the plan.
/// Threading: one thread, the control cycle. Nothing allocates, locks or throws.
class MotionRun {
public:
    /// Longest stop for which stop() keeps the plan's limits.
    static constexpr Seconds kGentleStop{0.5};
    /// Multiple of the robot's own acceleration and jerk that halt() uses.
    static constexpr double kHaltFactor = 2.0;

    /// Starts at rest at the beginning of the path, moving with the first next().
    /// \param late without it no step is too late
    explicit MotionRun(Trajectory trajectory, const LateCyclePolicy& late = {}) noexcept;

    /// Advances by `step` and returns the set-point. A late cycle passes its longer step and so
    /// stays on time. A step that skips more cycles than the policy allows stops the motion on its
    /// path, as stop() does, and advances by one cycle only: the arm must not leap to catch up.
    /// \param step >= 0
    SetPoint next(Seconds step) noexcept;
    /// Last set-point that next() returned; before that the start of the path.
    const SetPoint& current() const noexcept { return current_; }

    /// Brakes on the path to rest, for Suspend. Keeps the plan's limits if they bring the motion to
    /// rest within kGentleStop, else uses the robot's own. Takes effect at next().
    void stop() noexcept;
    /// Brakes like stop(), but in exactly this time by a PaceBrake, whatever the limits are. The
    /// caller must see that the axes can do it.
    /// \param length [s], > 0
    void stopIn(Seconds length) noexcept;
    /// Brakes on the path with kHaltFactor times the robot's own acceleration and jerk, for Halt.
    /// Also while a stop brakes. Takes effect at next().
    void halt() noexcept;
    /// Goes on to the end of the path, from rest or while it still brakes. Does nothing unless it
    /// was stopped.
    void resume() noexcept;
    /// Sets the speed as a share of the planned speed; it changes within the plan's limits. After a
    /// stop it takes effect with resume().
    /// \param factor clamped to [0, 1]; 0: the arm stands still on the path
    void setOverride(double factor) noexcept;

    /// Reports whether it stopped because a cycle came too late; false again after resume().
    bool stoppedLate() const noexcept { return stopped_late_; }
    /// Reports whether the set-points stand still: the end of the path or of the braking is
    /// reached.
    bool atRest() const noexcept;
    /// Reports whether the arm is at rest at the end of the path.
    bool finished() const noexcept;
    /// Place on the path, 0 start to 1 end.
    double pathParameter() const noexcept;
    /// Time until rest at the end [s]; while stopped or braking for a stop, time until rest.
    Seconds remaining() const noexcept;
    /// Time and way that halt() would need from here to rest; both zero at rest.
    StoppingEstimate stoppingEstimate() const noexcept;
    /// The motion that is run; valid as long as this.
    const Trajectory& trajectory() const noexcept { return trajectory_; }

private:
    enum class Mode { running, stopping };

    /// Quantity that the profile moves: the clock or the path parameter.
    enum class Along { clock, path };

    bool tooLate(Seconds step) const noexcept;
    ScalarState onPath() const noexcept;
    ScalarState onClock() const noexcept;
    void brake(double factor) noexcept;
    void brakeHarder() noexcept;
    void follow(const Profile& profile, Along along, const ScalarState& now) noexcept;
    void goOn() noexcept;

    Trajectory trajectory_;
    LateCyclePolicy late_;
    bool stopped_late_ = false;
    Mode mode_ = Mode::running;
    double override_ = 1.0;
    Along along_ = Along::clock;
    ScalarState state_;  ///< state of the clock or of the path parameter, see along_
    Profile profile_;
    double profile_time_ = 0;
    double brake_factor_ = 0;        ///< share of the robot's limits that a stop uses; 0: the
                                     ///< plan's
    std::optional<PaceBrake> pace_;  ///< pace of profile_time_ during stopIn()
    SetPoint current_;
};

}  // namespace metier::motion
