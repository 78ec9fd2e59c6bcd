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

/// How a stream of set-points is played out.
struct StreamOptions {
    Seconds cycle{0.008};          ///< of the controller, > 0
    int playout_delay_cycles = 3;  ///< from a set-point's intended time to its execution, >= 0;
                                   ///< 0: every cycle takes the newest set-point at once
    int stale_cycles = 6;          ///< with nothing to play, then it gives up, >= 1
    /// Without delay: so many cycles without a set-point go on as those before, >= 0.
    int extrapolated_cycles = 3;
    /// Without delay: a stream whose axes are all no faster stands, and in silence its last
    /// set-point is held; >= 0 [rad/s].
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

/// A set-point that was not taken. No text, so that the cycle thread need not allocate.
struct StreamRefusal {
    enum class Reason { wrong_size, not_finite, position_limit, jump, not_later, timed_out };
    Reason reason = Reason::wrong_size;
    std::size_t axis = 0;  ///< from 0
    double value = 0;      ///< [rad]; a number of axes for wrong_size; [s] for not_later
    double limit = 0;
};
/// For the person: axis, value, limit, unit.
Error toError(const StreamRefusal& refusal);

/// Follows joint positions that arrive irregularly, never breaking an axis limit.
///
/// The stream is played out a constant delay after its intended times, interpolated in between, and
/// passed through unchanged as long as the limits allow; else followed as fast as they allow. When
/// nothing is left to play it brakes; if that lasts for stale_cycles it stays stopped and reports
/// it. Without a delay a cycle's target is the newest set-point, or, where a set-point of the
/// stream's rhythm is late, what it would be at the last velocity and acceleration. Threading: one
/// thread, the control cycle. accept() and next() do not allocate, lock or throw.
class StreamFollower {
public:
    enum class State {
        waiting,    ///< no set-point yet: holds
        following,  ///< plays the stream
        stopping,   ///< stream silent: brakes
        timed_out,  ///< at rest after the stream fell silent
    };

    /// \param start where the arm stands, at rest: the first set-point is checked against it
    /// Errors: invalid_argument (sizes, options out of range).
    static Result<StreamFollower> create(const RobotModel& model, const StreamOptions& options,
                                         const JointVector& start);

    /// Takes a set-point, or leaves everything unchanged and says why not.
    /// \param intended_time on the sender's clock; later than the one before
    /// \param now           on the clock of next()
    std::optional<StreamRefusal> accept(const JointVector& position, Seconds intended_time,
                                        Seconds now) noexcept;

    /// How much longer than the play-out delay a set-point meant for that time would wait if it
    /// came now [s]; negative: it would be late. 0 without a delay, and before the first set-point.
    Seconds lagOf(Seconds intended_time, Seconds now) const noexcept;
    /// Skips what is left to play if that is nothing but standing still where the arm rests, as far
    /// as it delays a set-point meant for that time.
    void skipRest(Seconds intended_time, Seconds now) noexcept;

    /// The set-point of this cycle. \param now one cycle later than at the call before
    SetPoint next(Seconds now) noexcept;

    /// Ends the stream: brakes to rest, then timed_out.
    void stop() noexcept;

    State state() const noexcept { return state_; }
    bool atRest() const noexcept;
    std::uint64_t acceptedCount() const noexcept { return accepted_; }
    /// Cycles for which no set-point was there in time; those that went on without delay do not
    /// count.
    std::uint64_t missedCycles() const noexcept { return missed_; }

private:
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
    /// The stream's position at a time of the sender's clock; after its last one that, without
    /// delay bridged().
    JointVector play(double time) const noexcept;
    JointVector bridged(double time) const noexcept;
    /// How far an axis of the stream goes on after its last set-point: at its last velocity and
    /// acceleration, but never back [rad].
    double goingOn(std::size_t axis, double ahead) const noexcept;
    bool withoutDelay() const noexcept { return options_.playout_delay_cycles == 0; }
    double longestBridge() const noexcept;
    bool standing() const noexcept;
    void waitFor(double time, double now) noexcept;
    bool onlyRestIsLeft(double played) const noexcept;
    /// The target of this cycle and of the three before.
    using Targets = std::array<JointVector, 4>;
    void follow(const Targets& targets) noexcept;
    /// Without delay targets carry noise: one that no axis could follow is one of a steady motion.
    TargetStates statesOf(const Targets& targets, std::size_t axis) const noexcept;
    void take(std::size_t axis, const ScalarState& next) noexcept;
    void playAt(double now) noexcept;
    void playNewest() noexcept;
    void correctTargets() noexcept;
    void brakeForSilence() noexcept;
    void startBraking() noexcept;
    void brake() noexcept;

    StreamOptions options_;
    std::array<JointLimits, kMaxAxes> limits_{};
    SetPoint now_;
    State state_ = State::waiting;
    std::array<Knot, kKnots> knots_{};
    std::size_t newest_ = 0;
    std::size_t knot_count_ = 0;
    bool fresh_ = false;  ///< a set-point came since the last cycle
    // Without delay, of the last cycle:
    double played_ = 0;  ///< on the sender's clock [s]
    Targets targets_{};  ///< what was followed in this cycle and the three before
    double offset_ = 0;  ///< from the sender's clock to ours [s]
    struct Brake {
        Profile profile;
        int cycles = 0;  ///< since its start
    };
    std::array<Brake, kMaxAxes> brakes_;
    int silent_cycles_ = 0;
    std::uint64_t accepted_ = 0;
    std::uint64_t missed_ = 0;
};

}  // namespace metier::motion
