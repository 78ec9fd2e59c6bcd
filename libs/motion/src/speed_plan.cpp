#include "speed_plan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "fastest_course.hpp"
#include "metier/base/numbers.hpp"

namespace metier::motion {

namespace {

/// Shares of acceleration and jerk limits that the bends of the path may use up: stops need the
/// rest.
constexpr double kBendAcceleration = 0.65;
constexpr double kBendJerk = 0.65;
/// Share of the limits that the map uses: the rest is for a clock that changes its speed.
constexpr double kMapShare = 0.8;
/// An even speed is good enough if it takes at most this many times the least possible time.
constexpr double kGoodEnough = 1.15;
/// Margins for the bending of a path between its knots: a factor of the second derivative, and a
/// share of the third derivative's change from knot to knot.
constexpr double kUnseenSecond = 1.02;
constexpr double kUnseenThird = 0.5;
/// A plan whose derivatives use this share of a limit is checked by its exact positions, with steps
/// that are not so short that rounding shows [s].
constexpr double kNear = 0.5;
constexpr double kShortestStep = 4e-4;
constexpr double kLongestStep = 1e-3;
/// Over a limit by no more than this counts as within it.
constexpr double kTolerance = 3e-4;

/// Derivatives of a bounded value by the clock.
struct ByClock {
    double first = 0;
    double second = 0;
    double third = 0;
};

/// \param s velocity, acceleration and jerk of the path parameter by the clock
struct ParameterMotion {
    double velocity = 0;
    double acceleration = 0;
    double jerk = 0;
};

ByClock byClock(const SpeedBound& d, const ParameterMotion& s) noexcept {
    const double w = s.velocity;
    const double b = d.lengths ? std::abs(s.acceleration) : s.acceleration;
    const double j = d.lengths ? std::abs(s.jerk) : s.jerk;
    return {std::abs(d.first * w), std::abs(d.second * w * w + d.first * b),
            std::abs(d.third * w * w * w + 3 * d.second * w * b + d.first * j)};
}

/// Squares of the speeds that velocity and bends allow at each knot.
std::vector<double> speedCaps(const std::vector<SpeedBounds>& bounds) {
    std::vector<double> caps;
    caps.reserve(bounds.size());
    for (const SpeedBounds& at : bounds) {
        double cap = kInfinity;
        for (std::size_t i = 0; i < at.count; ++i) {
            const SpeedBound& bound = at.values[i];
            const double fastest = bound.velocity / std::abs(bound.first);
            const double bent = std::cbrt(kBendJerk * bound.jerk / std::abs(bound.third));
            cap = std::min({cap, fastest * fastest, bent * bent,
                            kBendAcceleration * bound.acceleration / std::abs(bound.second)});
        }
        caps.push_back(cap);
    }
    return caps;
}

/// Most that half the square of the speed may rise per path parameter.
double steepest(const SpeedBounds& at, double z, double share) noexcept {
    double slope = kInfinity;
    for (std::size_t i = 0; i < at.count; ++i) {
        const SpeedBound& bound = at.values[i];
        const double bent = bound.lengths || bound.first * bound.second > 0
                                ? std::abs(bound.second)
                                : -std::abs(bound.second);
        slope = std::min(slope, (share * bound.acceleration - bent * z) / std::abs(bound.first));
    }
    return std::max(slope, 0.0);
}

/// Lowers the squares of the speeds to what the accelerations allow.
void limitSlope(const std::vector<double>& places, const std::vector<SpeedBounds>& bounds,
                double share, std::vector<double>& z) {
    for (std::size_t k = 1; k < z.size(); ++k) {
        const double rise = 2 * steepest(bounds[k - 1], z[k - 1], share);
        z[k] = std::min(z[k], z[k - 1] + (places[k] - places[k - 1]) * rise);
    }
    for (std::size_t k = z.size() - 1; k > 0; --k) {
        const double rise = 2 * steepest(bounds[k], z[k], share);
        z[k - 1] = std::min(z[k - 1], z[k] + (places[k] - places[k - 1]) * rise);
    }
}

/// Least time that the accelerations alone allow.
double leastTime(const std::vector<double>& places, const std::vector<double>& z) {
    double time = 0;
    for (std::size_t k = 1; k < z.size(); ++k) {
        time += 2 * (places[k] - places[k - 1]) / (std::sqrt(z[k - 1]) + std::sqrt(z[k]));
    }
    return time;
}

LimitsAlong::Place clockShares(const SpeedBounds& at, const ParameterMotion& s) noexcept {
    LimitsAlong::Place place;
    for (std::size_t i = 0; i < at.count; ++i) {
        const SpeedBound& bound = at.values[i];
        const ByClock d = byClock(bound, s);
        place[i] = LimitsAlong::shareOf(
            {d.first, d.second, d.third, bound.velocity, bound.acceleration, bound.jerk});
    }
    return place;
}

SpeedPlan withClock(SpeedMap map, LimitsAlong clock) {
    SpeedPlan plan{std::move(map), std::move(clock), 1.0, {}};
    plan.profile = plan.clock.toRest({}, plan.map.end(), plan.velocity);
    return plan;
}

SpeedPlan planEven(const std::vector<double>& places, const std::vector<SpeedBounds>& bounds,
                   double speed) {
    std::vector<double> at;
    std::vector<LimitsAlong::Place> clock;
    for (std::size_t k = 0; k < places.size(); ++k) {
        at.push_back(places[k] / speed);
        clock.push_back(clockShares(bounds[k], {speed, 0, 0}));
    }
    return withClock(SpeedMap::constant(speed), {std::move(at), std::move(clock)});
}

/// The least limits of the path parameter at a speed.
ScalarLimits& narrow(ScalarLimits& limits, const SpeedBounds& at) noexcept {
    const double w = limits.velocity;
    for (std::size_t i = 0; i < at.count; ++i) {
        const auto& b = at.values[i];
        const double f = std::abs(b.first);
        limits.acceleration =
            std::min(limits.acceleration, (b.acceleration - std::abs(b.second) * w * w) / f);
        limits.jerk = std::min(limits.jerk, (b.jerk - std::abs(b.third) * w * w * w) / (2 * f));
    }
    return limits;
}

/// The knot up to which the speed stays the same, so that the clock can start or stop meanwhile.
/// \param knots from that end of the path inwards
template <typename Knot>
std::size_t evenKnots(const std::vector<double>& places, const std::vector<SpeedBounds>& bounds,
                      const std::vector<double>& z, const Knot& knot) {
    ScalarLimits limits{kInfinity, kInfinity, kInfinity};
    for (std::size_t n = 0; n < z.size(); ++n) {
        const std::size_t k = knot(n);
        limits.velocity = std::min(limits.velocity, std::sqrt(z[k]));
        narrow(limits, bounds[k]);
        const double way = std::abs(places[k] - places[knot(0)]);
        const double w = limits.velocity;
        const double time = w * limits.jerk > limits.acceleration * limits.acceleration
                                ? w / limits.acceleration + limits.acceleration / limits.jerk
                                : 2 * std::sqrt(w / limits.jerk);
        if (w * time / 2 <= way) {
            return n;
        }
    }
    return z.size();
}

/// Checks a plan against every bound: everywhere by the derivatives at the knots, and where these
/// come near a limit by the exact positions, since a path bends between its knots.
class Excess {
public:
    Excess(const std::vector<double>& places, const std::vector<SpeedBounds>& bounds,
           const ExactPath& exact, const SpeedPlan& plan)
        : places_(places), bounds_(bounds), exact_(exact), plan_(plan) {
        double before = 0;
        for (std::size_t k = 1; k < places.size(); ++k) {
            const double time = timeAt(plan.map.clockAt(places[k]));
            check(k - 1, before, time);
            before = time;
        }
        const Profile& profile = plan.profile;
        constexpr int parts = 96;
        for (int part = 0; part < parts; ++part) {
            const double u = (part + 0.5) / parts;
            include(u * profile.steadyFrom());
            include(profile.duration() + u * (profile.steadyTo() - profile.duration()));
        }
        includeBends(profile);
    }
    /// Factor by which the duration has to grow.
    double factor() const noexcept { return factor_; }

private:
    /// Positions are taken at no more places than this from knot to knot.
    static constexpr double kMostSteps = 64;
    /// Factor by which the jerk may exceed what positions at steps show, if these show too much. A
    /// clock that changes its speed at exactly the jerk limit is not slowed down for it.
    static constexpr double kBetween = 1.03;
    /// Share of the jerk limit above which steps may hide a peak over it.
    static constexpr double kPeak = 0.92;

    /// Includes both sides of the places where the clock's jerk changes: accelerations have their
    /// peaks there.
    void includeBends(const Profile& profile) noexcept {
        double time = 0;
        for (std::size_t piece = 0; piece + 1 < profile.pieceCount(); ++piece) {
            time += profile.pieceDuration(piece);
            include(time * (1 - 1e-9));
            include(time * (1 + 1e-9));
        }
    }

    /// Time at which the clock has this value [s].
    double timeAt(double clock) const noexcept {
        const Profile& profile = plan_.profile;
        const double steady = profile.at(profile.steadyFrom()).position;
        const double time = profile.steadyFrom() + (clock - steady) / plan_.velocity;
        if (clock >= steady && time <= profile.steadyTo()) {
            return time;
        }
        double low = clock < steady ? 0 : profile.steadyTo();
        double high = clock < steady ? profile.steadyFrom() : profile.duration();
        constexpr int halvings = 40;
        for (int i = 0; i < halvings; ++i) {
            const double middle = low + (high - low) / 2;
            (profile.at(middle).position < clock ? low : high) = middle;
        }
        return high;
    }

    /// Checks from one time to another [s], from that knot to the next one.
    void check(std::size_t knot, double from, double to) {
        constexpr int parts = 4;
        double share = 0;
        for (int part = 0; part <= parts; ++part) {
            // Not on the knots: third derivatives jump there.
            const double u = std::clamp(static_cast<double>(part) / parts, 1e-6, 1 - 1e-6);
            share = std::max(share, include(std::lerp(from, to, u)));
        }
        knot_ = knot;
        checks_tool_ = exact_.tool.applies(knot);
        if (share >= kNear || checks_tool_) {
            includeExact(from, to);
        }
    }

    /// \return the largest share of a limit that a derivative by time uses at `time` [s]
    double include(double time) noexcept {
        const ScalarState clock = plan_.profile.at(time);
        const double clock_jerk = plan_.profile.jerkAt(time);
        const ScalarState s = plan_.map.at(clock.position);
        const double v = clock.velocity;
        const ParameterMotion motion{
            s.velocity * v, s.velocity * clock.acceleration + s.acceleration * v * v,
            s.velocity * clock_jerk + 3 * s.acceleration * v * clock.acceleration +
                plan_.map.jerkAt(clock.position) * v * v * v};
        const auto after = std::upper_bound(places_.begin() + 1, places_.end() - 1, s.position);
        const auto k = static_cast<std::size_t>(after - places_.begin()) - 1;
        double share = 0;
        for (std::size_t i = 0; i < bounds_[k].count; ++i) {
            SpeedBound bound = between(bounds_[k].values[i], bounds_[k + 1].values[i]);
            const double part = (s.position - places_[k]) / (places_[k + 1] - places_[k]);
            bound.first =
                std::lerp(bounds_[k].values[i].first, bounds_[k + 1].values[i].first, part);
            bound.second *= kUnseenSecond;
            const double change = bounds_[k].values[i].third - bounds_[k + 1].values[i].third;
            bound.third += std::copysign(kUnseenThird * change, bound.third);
            const ByClock d = byClock(bound, motion);
            const bool runs_on = s.velocity > 0;
            const double least = runs_on ? factor_ : kInfinity;
            factor_ =
                std::max({least, d.first / bound.velocity, std::sqrt(d.second / bound.acceleration),
                          std::cbrt(d.third / bound.jerk)});
            share = std::max({share, d.second / bound.acceleration, d.third / bound.jerk});
        }
        return share;
    }

    /// Differences of positions from one time to another [s], and as far beyond as four of them
    /// reach; with half the step, and between these again, where they come near the jerk limit,
    /// since a peak between two steps is higher than both show.
    void includeExact(double from, double to) {
        const double step = std::max((to - from) / kMostSteps,
                                     std::clamp((to - from) / 4, kShortestStep, kLongestStep));
        if (includeSteps(from, to, step) > kPeak) {
            const double half = std::max(step / 2, kShortestStep);
            includeSteps(from - half / 2, to + half / 2, half);
        }
    }

    /// \return the largest share of a jerk limit
    double includeSteps(double from, double to, double step) {
        std::array<JointVector, 4> q;
        int taken = 0;
        double largest = 0;
        for (double time = from - 1.5 * step; time < to + 1.5 * step; time += step) {
            std::rotate(q.begin(), q.begin() + 1, q.end());
            q.back() = exact_.position(plan_.map.at(plan_.profile.at(time).position).position);
            if (++taken >= 4) {
                largest = std::max(largest, includeDifferences(q, step));
                if (checks_tool_) {
                    factor_ =
                        std::max(factor_, exact_.tool.factor(knot_, {{q[0], q[1], q[2]}, step}));
                }
            }
        }
        return largest;
    }

    /// \param q four positions, `step` [s] apart
    /// \return the largest share of a jerk limit
    double includeDifferences(const std::array<JointVector, 4>& q, double step) noexcept {
        double largest = 0;
        for (std::size_t i = 0; i < q[0].size(); ++i) {
            const SpeedBound& bound = bounds_.front().values[i];
            const double a = (q[2][i] - 2 * q[1][i] + q[0][i]) / (step * step);
            const double j = (q[3][i] - 3 * q[2][i] + 3 * q[1][i] - q[0][i]) / (step * step * step);
            const double shown = std::abs(j) / bound.jerk;
            const double jerk = shown > 1 + kTolerance ? kBetween * shown : shown;
            factor_ =
                std::max({factor_, std::sqrt(std::abs(a) / bound.acceleration), std::cbrt(jerk)});
            largest = std::max(largest, shown);
        }
        return largest;
    }

    const std::vector<double>& places_;
    const std::vector<SpeedBounds>& bounds_;
    const ExactPath& exact_;
    const SpeedPlan& plan_;
    std::size_t knot_ = 0;      // the last before the place that is checked
    bool checks_tool_ = false;  // there
    double factor_ = 1;
};

/// The plan, slowed down where it would not keep the bounds.
SpeedPlan withinBounds(const std::vector<double>& places, const std::vector<SpeedBounds>& bounds,
                       const ExactPath& exact, const SpeedPlan& plan) {
    const double factor = Excess(places, bounds, exact, plan).factor();
    return factor > 1 + kTolerance ? plan.slowed(factor) : plan;
}

/// The course between the places where the clock starts and stops.
Course courseOf(const std::vector<double>& places, const std::vector<SpeedBounds>& bounds,
                const std::vector<double>& ceiling) {
    const std::size_t last = places.size() - 1;
    Course course{places, bounds, ceiling, 0, 0};
    const std::size_t first = evenKnots(places, bounds, ceiling, [](std::size_t n) { return n; });
    const std::size_t even =
        evenKnots(places, bounds, ceiling, [&](std::size_t n) { return last - n; });
    if (first + even + 3 > last) {
        return course;
    }
    course.first = first;
    course.last = last - even;
    const auto lowest = [&](std::size_t from, std::size_t to) {
        return *std::min_element(ceiling.begin() + static_cast<std::ptrdiff_t>(from),
                                 ceiling.begin() + static_cast<std::ptrdiff_t>(to) + 1);
    };
    course.ceiling[first] = lowest(0, first);
    course.ceiling[course.last] = lowest(course.last, last);
    return course;
}

/// \return nothing where the path is too short for it
std::optional<SpeedPlan> planVarying(const Course& course) {
    if (course.last == 0) {
        return std::nullopt;
    }
    std::vector<double> speed;
    std::vector<double> slope;
    for (const CourseSpeed& at : fastestCourse(course, kMapShare)) {
        speed.push_back(std::sqrt(at.square));
        slope.push_back(at.slope);
    }
    SpeedMap map = SpeedMap::varying(course.places, speed, slope);
    // If the speed changes too steeply from knot to knot, its square has no course between them.
    if (!std::isfinite(map.end())) {
        return std::nullopt;
    }
    std::vector<double> at;
    std::vector<LimitsAlong::Place> shares;
    for (std::size_t k = 0; k < course.places.size(); ++k) {
        at.push_back(map.clockAt(course.places[k]));
        const double before = std::abs(map.jerkAt(at.back() * (1 - 1e-9)));
        const double after = std::abs(map.jerkAt(at.back() * (1 + 1e-9)));
        shares.push_back(
            clockShares(course.bounds[k], {speed[k], slope[k], std::max(before, after)}));
    }
    return withClock(std::move(map), {std::move(at), std::move(shares)});
}

}  // namespace

SpeedPlan SpeedPlan::slowed(double factor) const {
    return {map, clock.slowed(factor), velocity / factor, profile.slowed(factor)};
}

SpeedPlan evenSpeed(const ScalarLimits& limits) {
    LimitsAlong::Place place;
    const double v = limits.velocity;
    if (v < kInfinity) {
        place[0] = LimitsAlong::shareOf({v, 0, 0, v, limits.acceleration, limits.jerk});
    }
    return withClock(SpeedMap::constant(v), LimitsAlong(place));
}

SpeedPlan planSpeed(const std::vector<double>& places, const std::vector<SpeedBounds>& bounds,
                    const ExactPath& exact) {
    const std::vector<double> caps = speedCaps(bounds);
    std::vector<double> reached = caps;
    reached.front() = reached.back() = 0;
    limitSlope(places, bounds, 1.0, reached);
    const double slowest = *std::min_element(caps.begin(), caps.end());
    const double fastest = *std::max_element(reached.begin(), reached.end());
    SpeedPlan even = withinBounds(places, bounds, exact,
                                  planEven(places, bounds, std::sqrt(std::min(slowest, fastest))));
    if (slowest >= fastest || even.profile.duration() <= kGoodEnough * leastTime(places, reached)) {
        return even;
    }
    std::vector<double> ceiling = caps;
    limitSlope(places, bounds, kMapShare, ceiling);
    auto varying = planVarying(courseOf(places, bounds, ceiling));
    if (!varying) {
        return even;
    }
    SpeedPlan within = withinBounds(places, bounds, exact, std::move(*varying));
    return within.profile.duration() < even.profile.duration() ? within : even;
}

}  // namespace metier::motion
