#pragma once

#include <optional>

#include "metier/motion/pace_brake.hpp"
#include "metier/motion/trajectory.hpp"

namespace metier::motion {

/// What a cycle that comes late means for a motion.
struct LateCyclePolicy {
    Seconds cycle{0};      ///< of the controller; 0: no step is too late
    int most_skipped = 4;  ///< cycles one step may skip; when more are missing the motion stops
};

/// Time and way that a motion needs to stand.
struct StoppingEstimate {
    Seconds time{0};
    double distance = 0;  ///< between where the tool frame's origin is and where it will stand [m]
};

/// A trajectory while it runs: gives the set-point of each cycle, brakes and goes on along the
/// path.
///
/// Stop, halt, resume and override act along the path only: the arm never leaves it. How soon it
/// stands after halt() depends on the robot's own limits, never on those of the plan.
/// Threading: one thread, the control cycle. Nothing allocates, locks or throws.
class MotionRun {
public:
    /// Longest stop for which stop() keeps the plan's limits.
    static constexpr Seconds kGentleStop{0.5};
    /// What halt() uses of the robot's own acceleration and jerk.
    static constexpr double kHaltFactor = 2.0;

    /// Starts at rest at the beginning of the path, moving with the first next().
    explicit MotionRun(Trajectory trajectory, const LateCyclePolicy& late = {}) noexcept;

    /// The set-point `step` later. A late cycle passes its longer step and stays on time. One that
    /// skips more cycles than the policy allows stops the motion on its path, as stop() does, and
    /// goes on by one cycle only: the arm is not asked to catch up with a leap.
    /// \param step >= 0
    SetPoint next(Seconds step) noexcept;
    /// The set-point last given; the start of the path before the first next().
    const SetPoint& current() const noexcept { return current_; }

    /// Brakes on the path to rest: Suspend. Keeps the plan's limits if the motion stands within
    /// kGentleStop by them, else takes the robot's own. Takes effect at next().
    void stop() noexcept;
    /// As stop(), but in exactly that time, as PaceBrake does, whatever the limits are.
    /// \param length [s], > 0
    void stopIn(Seconds length) noexcept;
    /// Brakes on the path with kHaltFactor times the robot's own acceleration and jerk: Halt.
    void halt() noexcept;
    /// Goes on to the end of the path, from rest or while still braking.
    void resume() noexcept;
    /// Speed as a share of the planned one. \param factor clamped to [0, 1]; 0 stands on the path
    void setOverride(double factor) noexcept;

    /// Whether it stopped because a cycle came too late; false again after resume().
    bool stoppedLate() const noexcept { return stopped_late_; }
    bool atRest() const noexcept;
    /// At rest at the end of the path.
    bool finished() const noexcept;
    /// Where on the path, 0 start to 1 end.
    double pathParameter() const noexcept;
    /// Until rest at the end; while stopped or braking for a stop, until rest.
    Seconds remaining() const noexcept;
    /// Time and way that halt() would need from here to rest; zero at rest.
    StoppingEstimate stoppingEstimate() const noexcept;
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
    ScalarState state_;  ///< of the clock or of the path parameter, as along_ says
    Profile profile_;
    double profile_time_ = 0;
    double brake_factor_ = 0;        ///< part of the robot's limits that a stop uses; 0: the plan's
    std::optional<PaceBrake> pace_;  ///< of profile_time_, while it stops by it
    SetPoint current_;
};

}  // namespace metier::motion
