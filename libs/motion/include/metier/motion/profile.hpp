#pragma once

#include <array>
#include <cstddef>

namespace metier::motion {

/// Position along one dimension and its first two time derivatives.
struct ScalarState {
    double position = 0;
    double velocity = 0;
    double acceleration = 0;
};

/// Bounds of |velocity|, |acceleration| and |jerk| along one dimension, all > 0.
struct ScalarLimits {
    double velocity = 0;
    double acceleration = 0;
    double jerk = 0;
};

/// A jerk-limited motion along one dimension that ends at rest: a few pieces of constant jerk.
///
/// Threading: a value; nothing allocates, locks or throws.
/// Source: docs/motion.md#profile.
class Profile {
public:
    Profile() = default;
    /// Motion from any state to rest at `target`, as quick as the limits allow (time-optimal except
    /// for extreme start accelerations).
    static Profile toRest(const ScalarState& start, double target,
                          const ScalarLimits& limits) noexcept;
    /// Motion from any state to rest, as soon as the limits allow, at any position.
    static Profile brake(const ScalarState& start, const ScalarLimits& limits) noexcept;

    /// The same motion in `factor` > 0 times the time.
    Profile slowed(double factor) const noexcept;

    /// Time from start to rest [s].
    double duration() const noexcept { return duration_; }
    /// State after `time` [s]; before 0 the start state, after duration() exactly the end state, at
    /// rest.
    ScalarState at(double time) const noexcept;
    /// Jerk after `time` [s]; 0 after duration().
    double jerkAt(double time) const noexcept;
    /// Position at the end, at rest.
    double end() const noexcept { return end_; }
    /// Begin and end of constant velocity [s]; equal if the velocity is constant nowhere.
    double steadyFrom() const noexcept { return steady_from_; }
    double steadyTo() const noexcept { return steady_to_; }

private:
    struct Piece {
        double duration = 0;
        double jerk = 0;
        ScalarState start;
    };
    static constexpr std::size_t kMaxPieces = 8;

    void append(double duration, double jerk) noexcept;
    void changeVelocity(double to_velocity, const ScalarLimits& limits) noexcept;

    std::array<Piece, kMaxPieces> pieces_{};
    std::size_t piece_count_ = 0;
    ScalarState now_;
    double duration_ = 0;
    double steady_from_ = 0;
    double steady_to_ = 0;
    double end_ = 0;
};

}  // namespace metier::motion
