#pragma once

#include <array>
#include <cstddef>

namespace metier::motion {

/// Position along one dimension and its first two time derivatives. The unit of length is the
/// user's: rad, m, a path parameter, or s of planned time; time is in s.
/// Values may have either sign.
struct ScalarState {
    /// From the origin of that dimension.
    double position = 0;
    /// Unit of length per second.
    double velocity = 0;
    /// Unit of length per second squared.
    double acceleration = 0;
};

/// Bounds of |velocity|, |acceleration| and |jerk| along one dimension, all > 0, in the same unit
/// of length.
/// They hold in both directions.
struct ScalarLimits {
    double velocity = 0;
    double acceleration = 0;
    double jerk = 0;
};

/// A jerk-limited motion along one dimension that ends at rest: at most 8 pieces of constant jerk.
///
/// Threading: a value; nothing allocates, locks or throws.
/// Source: docs/motion.md#profile.
///
///     const auto profile = Profile::toRest({.position = 0.2}, 1.0, {0.5, 2.0, 20.0});
///     for (double t = 0.0; t < profile.duration(); t += cycle) { move(profile.at(t).position); }
class Profile {
public:
    /// Rest at position 0.
    Profile() = default;
    /// Motion from any state to rest at `target`, as quick as the limits allow (time-optimal except
    /// for extreme start accelerations).
    /// The velocity limit is reached if the way is long enough. A start that is too fast to stop
    /// before the target passes it and comes back.
    static Profile toRest(const ScalarState& start, double target,
                          const ScalarLimits& limits) noexcept;
    /// Motion from any state to rest, as soon as the limits allow, at any position. A velocity over
    /// its limit is allowed.
    /// No duration for a start at rest.
    static Profile brake(const ScalarState& start, const ScalarLimits& limits) noexcept;

    /// The same motion in `factor` > 0 times the time.
    /// The positions stay; velocity, acceleration and jerk are those of this one divided by factor,
    /// its square and its cube.
    Profile slowed(double factor) const noexcept;

    /// Time from start to rest [s].
    double duration() const noexcept { return duration_; }
    /// State after `time` [s]; before 0 the start state, after duration() exactly the end state, at
    /// rest.
    /// Position, velocity and acceleration have no jump between the two ends.
    ScalarState at(double time) const noexcept;
    /// Jerk after `time` [s]; 0 after duration(), that of the start before 0.
    double jerkAt(double time) const noexcept;
    /// Number of its parts of constant jerk.
    std::size_t pieceCount() const noexcept { return piece_count_; }
    /// Duration of one of them, in the order of time [s].
    double pieceDuration(std::size_t piece) const noexcept { return pieces_.at(piece).duration; }
    /// Position at the end, at rest.
    double end() const noexcept { return end_; }
    /// Begin of the part with constant velocity [s]; steadyTo() if the velocity is constant
    /// nowhere.
    double steadyFrom() const noexcept { return steady_from_; }
    /// End of that part [s].
    double steadyTo() const noexcept { return steady_to_; }

private:
    /// Part of constant jerk: state at its begin, and how long it lasts [s]. A piece of no duration
    /// is not kept.
    struct Piece {
        double duration = 0;
        double jerk = 0;
        ScalarState start;
    };
    static constexpr std::size_t kMaxPieces = 8;

    void append(double duration, double jerk) noexcept;
    /// Appends up to three pieces that end at this velocity without acceleration.
    void changeVelocity(double to_velocity, const ScalarLimits& limits) noexcept;

    std::array<Piece, kMaxPieces> pieces_{};
    std::size_t piece_count_ = 0;
    // State at the end of the last piece, while the profile is made.
    ScalarState now_;
    double duration_ = 0;
    double steady_from_ = 0;
    double steady_to_ = 0;
    double end_ = 0;
};

}  // namespace metier::motion
