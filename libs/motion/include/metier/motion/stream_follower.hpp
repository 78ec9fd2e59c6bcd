#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "metier/base/error.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/motion/trajectory.hpp"

namespace metier::motion {

struct FollowerLimits;
struct TargetStates;

/// Options of playing out a stream of set-points.
///
/// A larger play-out delay forgives a more irregular network, at the price of a later arm: with a
/// cycle of 8 ms, the default of 3 cycles plays each set-point 24 ms after it was meant. Values out
/// of range are refused by StreamFollower::create().
struct StreamOptions {
    /// Period of the controller [s], > 0.
    Seconds cycle{0.008};
    /// Delay from intended time to execution of a set-point [cycles], >= 0; 0: every cycle takes
    /// the newest set-point at once.
    int playout_delay_cycles = 3;
    /// Number of cycles with nothing to play before it gives up, >= 1.
    int stale_cycles = 6;
    /// Without delay: cycles without a set-point during which the motion is extrapolated, >= 0.
    int extrapolated_cycles = 3;
    /// Without delay: largest speed of any axis at which the stream counts as standing; then, if
    /// the stream is silent, its last set-point is held; >= 0 [rad/s].
    double standing_speed = 0.0;
    /// Largest step from one set-point to the next, as a multiple of what the axis' velocity limit
    /// allows in the time between them; > 0.
    double jump_factor = 2.0;
    /// Jerk that following may use, as a multiple of the axis' limit; > 0. A stream that uses its
    /// limit to the full is followed exactly only with room above it.
    double jerk_factor = 1.0;
    /// Acceleration that following may use while an axis brakes, as a multiple of its limit; >= 1.
    /// A motion that is halted is followed on its path with MotionRun::kHaltFactor.
    double braking_factor = 1.0;
};

/// A refused set-point. It has no text, so that the cycle thread need not allocate.
struct StreamRefusal {
    /// Kind of refusal.
    enum class Reason {
        wrong_size,      ///< another number of axes than the arm has
        not_finite,      ///< a value that is infinite or not a number
        position_limit,  ///< a value beyond the joint limits
        jump,            ///< too far from the set-point before, see StreamOptions::jump_factor
        not_later,       ///< its time is not after that of the set-point before
        timed_out        ///< the stream is over: silent for StreamOptions::stale_cycles, or stop()
    };
    /// Kind of the refusal, which decides what value and limit are.
    Reason reason = Reason::wrong_size;
    /// Axis that is refused, from 0; for not_finite, position_limit and jump.
    std::size_t axis = 0;
    /// Refused value [rad]; a number of axes for wrong_size; [s] for not_later and timed_out.
    double value = 0;
    /// Limit that it broke, in the same unit.
    double limit = 0;
};
/// Error text for a person, with axis, value, limit and unit. Allocates. The code is
/// invalid_argument for wrong_size, not_finite and not_later, out_of_range for position_limit and
/// jump, timeout for timed_out.
Error toError(const StreamRefusal& refusal);

/// Follows joint positions that arrive irregularly, and never breaks an axis limit.
///
/// Threading: one thread, the control cycle. accept() and next() do not allocate, lock or throw.
///
///     auto follower = StreamFollower::create(model, {.cycle = Seconds(0.008)}, measured);
///     if (const auto refused = follower->accept(set_point, intended, now)) { ... }  // irregularly
///     send(follower->next(now).position);  // every cycle
class StreamFollower {
public:
    enum class State {
        /// No set-point yet: holds the start position.
        waiting,
        /// Plays the stream.
        following,
        /// The stream is silent, or stop() was called: brakes.
        stopping,
        /// At rest after that; set-points are refused for good.
        timed_out,
    };

    /// \param model its limits are copied
    /// \param start position at which the arm stands still [rad]; the first set-point is checked
    ///              against it
    /// Errors: invalid_argument (sizes, options out of range).
    static Result<StreamFollower> create(const RobotModel& model, const StreamOptions& options,
                                         const JointVector& start);

    /// Takes a set-point, or leaves everything unchanged and returns the reason.
    /// Checked in this order: stream over, number of axes, time, then each axis for finite, joint
    /// limits and jump. The first set-point counts as one play-out delay, at least one cycle, after
    /// the start.
    /// \param position      [rad], one value per axis, within the joint limits
    /// \param intended_time time of the set-point on the sender's clock [s]; later than the one
    ///                      before. Only differences count, so the two clocks need not agree.
    /// \param now           time on the clock of next() [s]
    std::optional<StreamRefusal> accept(const JointVector& position, Seconds intended_time,
                                        Seconds now) noexcept;

    /// Additional waiting time, beyond the play-out delay, of a set-point for `intended_time` that
    /// came now [s]; negative: it would be late. 0 without a delay, and before the first set-point.
    Seconds lagOf(Seconds intended_time, Seconds now) const noexcept;
    /// Skips the rest of the stream if the arm stands still and the rest only keeps it there, as
    /// far as that would delay a set-point for `intended_time`.
    void skipRest(Seconds intended_time, Seconds now) noexcept;

    /// Computes the set-point of this cycle, always within the axes' limits of position, velocity
    /// and acceleration, with StreamOptions::braking_factor and jerk_factor.
    /// Call it in every cycle, also if no set-point came.
    /// \param now one cycle later than at the call before [s]
    SetPoint next(Seconds now) noexcept;

    /// Ends the stream: brakes to rest; the state is timed_out then. Does not wait.
    void stop() noexcept;

    /// State after the last call of next() or accept().
    State state() const noexcept { return state_; }
    /// Reports whether the last set-point stands still: no axis has velocity or acceleration.
    bool atRest() const noexcept;
    /// Number of cycles for which no set-point was there in time; extrapolated cycles without delay
    /// do not count.
    std::uint64_t missedCycles() const noexcept { return missed_; }

private:
    /// A set-point: its time on the sender's clock [s] and its position [rad].
    struct Knot {
        double time = 0;
        JointVector position;
    };
    static constexpr std::size_t kKnots = 512;  // 0.5 s of a set-point every millisecond

    StreamFollower(const RobotModel& model, const StreamOptions& options,
                   const JointVector& start) noexcept;
    FollowerLimits limitsOf(std::size_t axis) const noexcept;
    std::optional<StreamRefusal> check(const JointVector& position, double time) const noexcept;
    void store(const JointVector& position, double time) noexcept;
    /// The `age`-th newest knot, 0 the newest.
    const Knot& knot(std::size_t age) const noexcept;
    double slope(std::size_t age, std::size_t axis) const noexcept;
    /// Position of the stream at a time of the sender's clock. After its last set-point: that one,
    /// or bridged() without delay.
    JointVector play(double time) const noexcept;
    JointVector bridged(double time) const noexcept;
    /// Extrapolated way of an axis after its last set-point, with its last velocity and
    /// acceleration, but never backwards [rad].
    double goingOn(std::size_t axis, double ahead) const noexcept;
    bool withoutDelay() const noexcept { return options_.playout_delay_cycles == 0; }
    double longestBridge() const noexcept;
    bool standing() const noexcept;
    void waitFor(double time, double now) noexcept;
    bool onlyRestIsLeft(double played) const noexcept;
    /// Targets of this cycle and of the three before.
    using Targets = std::array<JointVector, 4>;
    void follow(const Targets& targets) noexcept;
    /// Without delay targets have noise: a target state that no axis could follow is replaced by
    /// that of a steady motion.
    TargetStates statesOf(const Targets& targets, std::size_t axis) const noexcept;
    void take(std::size_t axis, const ScalarState& next) noexcept;
    void playAt(double now) noexcept;
    void playNewest() noexcept;
    void correctTargets() noexcept;
    void brakeForSilence() noexcept;
    void startBraking() noexcept;
    void brake() noexcept;

    // The jerk limits in limits_ have StreamOptions::jerk_factor in them already.
    StreamOptions options_;
    std::array<JointLimits, kMaxAxes> limits_{};
    // Last set-point that next() returned; the arm is assumed to be there.
    SetPoint now_;
    State state_ = State::waiting;
    std::array<Knot, kKnots> knots_{};
    std::size_t newest_ = 0;
    std::size_t knot_count_ = 0;
    bool fresh_ = false;  ///< a set-point has come since the last cycle
    // Values of the last cycle, without delay only:
    double played_ = 0;  ///< time that was played, on the sender's clock [s]
    Targets targets_{};  ///< targets that were followed in this cycle and the three before
    double offset_ = 0;  ///< from the sender's clock to ours [s]
    struct Brake {
        Profile profile;
        int cycles = 0;  ///< cycles since its start
    };
    std::array<Brake, kMaxAxes> brakes_;
    int silent_cycles_ = 0;
    std::uint64_t missed_ = 0;
};

}  // namespace metier::motion
