#include "speed_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace metier::motion {

namespace {

/// Shares of an axis' limits that the path's own bends may use up.
constexpr std::array kBendShares{0.5, 0.3, 0.15};
/// Shares of the requested acceleration and jerk for changes of speed that the bends ask for.
struct SlopeShares {
    double acceleration;
    double jerk;
};
constexpr std::array kSlopeShares{SlopeShares{0.1, 0.2}, SlopeShares{0.25, 0.3},
                                  SlopeShares{0.5, 0.3}, SlopeShares{0.5, 0.6},
                                  SlopeShares{0.7, 0.7}};
/// Share of a jerk limit for the clock's acceleration in a bend.
constexpr double kBendJerk = 0.25;

void raise(double& value, double candidate) {
    value = std::max(value, std::abs(candidate));
}

/// Derivatives of one axis at every knot, each the worst of the vicinity.
void differentiate(const std::vector<JointVector>& knots, std::size_t axis,
                   std::vector<SpeedBounds>& bounds) {
    const std::size_t last = knots.size() - 1;
    const auto scale = static_cast<double>(last);
    const auto q = [&](std::size_t k) { return knots[k][axis]; };
    const auto at = [&](std::size_t k) -> SpeedBound& { return bounds[k].values[axis]; };
    for (std::size_t k = 0; k < last; ++k) {
        const double first = scale * (q(k + 1) - q(k));
        raise(at(k).first, first);
        raise(at(k + 1).first, first);
    }
    for (std::size_t k = 1; k < last; ++k) {
        const double second = scale * scale * (q(k + 1) - 2 * q(k) + q(k - 1));
        for (const std::size_t n : {k - 1, k, k + 1}) {
            raise(at(n).second, second);
        }
    }
    for (std::size_t k = 1; k + 2 <= last; ++k) {
        const double third =
            scale * scale * scale * (q(k + 2) - 3 * q(k + 1) + 3 * q(k) - q(k - 1));
        for (const std::size_t n : {k - 1, k, k + 1, k + 2}) {
            raise(at(n).third, third);
        }
    }
    for (std::size_t k = 0; k <= last; ++k) {
        at(k).first += at(k).second / (2 * scale);  // between knots the slope is not the mean one
    }
}

/// Speed of the path parameter at a knot and its bend: d(speed^2/2)/ds and the derivative of that.
struct SpeedAt {
    double speed = 0;
    double slope = 0;
    double bend = 0;
};

/// What is left for the clock of one limit after the path's and the map's own share.
double leftFor(double limit, double used, double factor) noexcept {
    if (factor <= 0) {
        return std::numeric_limits<double>::infinity();
    }
    return std::max(limit - used, 0.0) / factor;
}

/// Derivatives of a bounded value by the clock, from those by the path parameter.
struct ByClock {
    double first;
    double second;
    double third;
};

ByClock byClock(const SpeedBound& bound, const SpeedAt& at) noexcept {
    const auto& [w, slope, bend] = at;
    const double b = std::abs(slope);
    return {bound.first * w, bound.second * w * w + bound.first * b,
            bound.third * w * w * w + 3 * bound.second * w * b + bound.first * w * std::abs(bend)};
}

/// Clock limits that keep tool frame and axes within theirs everywhere.
ScalarLimits clockLimits(const std::vector<SpeedBounds>& bounds, const std::vector<SpeedAt>& speeds,
                         const ScalarLimits& requested) {
    ScalarLimits limits{1.0, std::numeric_limits<double>::infinity(),
                        std::numeric_limits<double>::infinity()};
    const auto everywhere = [&](const auto& narrow) {
        for (std::size_t k = 0; k < speeds.size(); ++k) {
            narrow(SpeedBound{1, 0, 0, requested.velocity, requested.acceleration, requested.jerk},
                   speeds[k]);
            for (std::size_t i = 0; i < bounds[k].count; ++i) {
                narrow(bounds[k].values[i], speeds[k]);
            }
        }
    };
    everywhere([&](const SpeedBound& bound, const SpeedAt& at) {
        const ByClock d = byClock(bound, at);
        limits.acceleration =
            std::min({limits.acceleration, leftFor(bound.acceleration, d.second, d.first),
                      leftFor(kBendJerk * bound.jerk, 0, 3 * d.second)});
    });
    everywhere([&](const SpeedBound& bound, const SpeedAt& at) {
        const ByClock d = byClock(bound, at);
        limits.jerk =
            std::min(limits.jerk,
                     leftFor(bound.jerk, 3 * d.second * limits.acceleration + d.third, d.first));
    });
    return limits;
}

std::vector<double> speedCaps(const std::vector<SpeedBounds>& bounds, double requested,
                              double bend_share) {
    std::vector<double> caps;
    caps.reserve(bounds.size());
    for (const SpeedBounds& at : bounds) {
        double cap = requested;
        for (std::size_t i = 0; i < at.count; ++i) {
            const SpeedBound& bound = at.values[i];
            cap = std::min({cap, leftFor(bound.velocity, 0, bound.first),
                            std::sqrt(leftFor(bend_share * bound.acceleration, 0, bound.second)),
                            std::cbrt(leftFor(bend_share / 2 * bound.jerk, 0, bound.third))});
        }
        caps.push_back(cap);
    }
    return caps;
}

/// `z` with no slope steeper than `steepest` from one entry to the next.
void limitSlope(std::vector<double>& z, double steepest) {
    for (std::size_t k = 1; k < z.size(); ++k) {
        z[k] = std::min(z[k], z[k - 1] + steepest);
    }
    for (std::size_t k = z.size() - 1; k > 0; --k) {
        z[k - 1] = std::min(z[k - 1], z[k] + steepest);
    }
}

template <typename Combine>
std::vector<double> overWindow(const std::vector<double>& z, std::size_t half, Combine combine) {
    std::vector<double> result(z.size());
    const auto last = static_cast<std::ptrdiff_t>(z.size()) - 1;
    const auto reach = static_cast<std::ptrdiff_t>(half);
    for (std::ptrdiff_t k = 0; k <= last; ++k) {
        double value = z[static_cast<std::size_t>(std::clamp(k - reach, {}, last))];
        for (std::ptrdiff_t n = k - reach + 1; n <= k + reach; ++n) {
            value = combine(value, z[static_cast<std::size_t>(std::clamp(n, {}, last))]);
        }
        result[static_cast<std::size_t>(k)] = value;
    }
    return result;
}

std::vector<double> average(const std::vector<double>& z, std::size_t half) {
    auto result = overWindow(z, half, [](double a, double b) { return a + b; });
    for (double& value : result) {
        value /= static_cast<double>(2 * half + 1);
    }
    return result;
}

/// Below `z` everywhere, with corners rounded over two windows of `half` entries to each side.
std::vector<double> rounded(const std::vector<double>& z, std::size_t half) {
    const auto lowest = overWindow(z, 2 * half, [](double a, double b) { return std::min(a, b); });
    return average(average(lowest, half), half);
}

double steepest(const std::vector<double>& z) {
    double result = 0;
    for (std::size_t k = 1; k < z.size(); ++k) {
        result = std::max(result, std::abs(z[k] - z[k - 1]));
    }
    return result;
}

std::vector<SpeedAt> toSpeeds(const std::vector<double>& z) {
    const std::size_t last = z.size() - 1;
    const auto scale = static_cast<double>(last);
    std::vector<SpeedAt> speeds(z.size());
    for (std::size_t k = 0; k <= last; ++k) {
        const double before = z[k == 0 ? 0 : k - 1];
        const double after = z[std::min(k + 1, last)];
        speeds[k] = {std::sqrt(z[k]), scale * (after - before) / 4,
                     scale * scale * (after - 2 * z[k] + before) / 2};
    }
    return speeds;
}

double durationOf(const SpeedPlan& plan) {
    // Where the speed changes too steeply from knot to knot, its square has no course between them.
    const bool has_course = std::isfinite(plan.map.end());
    if (!has_course || plan.limits.acceleration <= 0 || plan.limits.jerk <= 0) {
        return std::numeric_limits<double>::infinity();
    }
    return Profile::toRest({}, plan.map.end(), plan.limits).duration();
}

/// A plan that follows the caps with slopes of such shares of the requested limits.
SpeedPlan planVarying(const std::vector<SpeedBounds>& bounds, const std::vector<double>& caps,
                      const ScalarLimits& requested, const SlopeShares& shares) {
    std::vector<double> z;
    z.reserve(caps.size());
    for (const double cap : caps) {
        z.push_back(cap * cap);
    }
    const auto scale = static_cast<double>(z.size() - 1);
    limitSlope(z, 2 * shares.acceleration * requested.acceleration / scale);
    const double fastest = std::sqrt(*std::max_element(z.begin(), z.end()));
    const double width = fastest * steepest(z) * scale / (shares.jerk * requested.jerk);
    const auto half = static_cast<std::size_t>(std::clamp(width * scale / 2, 1.0, scale / 2));
    const std::vector<SpeedAt> speeds = toSpeeds(rounded(z, half));
    std::vector<double> speed;
    std::vector<double> slope;
    for (const SpeedAt& entry : speeds) {
        speed.push_back(entry.speed);
        slope.push_back(entry.slope);
    }
    return {SpeedMap::varying(speed, slope), clockLimits(bounds, speeds, requested)};
}

}  // namespace

SpeedMap SpeedMap::constant(double speed) {
    SpeedMap map;
    map.speed_ = speed;
    map.end_ = 1 / speed;
    return map;
}

SpeedMap SpeedMap::varying(const std::vector<double>& speed, const std::vector<double>& slope) {
    SpeedMap map;
    const double step = 1 / static_cast<double>(speed.size() - 1);
    for (std::size_t k = 0; k < speed.size(); ++k) {
        if (k > 0) {
            // Simpson's rule on 1/speed, the speed half way from the cubic through both squares.
            const double z = (speed[k - 1] * speed[k - 1] + speed[k] * speed[k]) / 2 +
                             step * (slope[k - 1] - slope[k]) / 4;
            const double middle = std::sqrt(z);
            map.end_ += step / 6 * (1 / speed[k - 1] + 4 / middle + 1 / speed[k]);
        }
        map.nodes_.push_back({map.end_, {static_cast<double>(k) * step, speed[k], slope[k]}});
    }
    return map;
}

ScalarState SpeedMap::at(double clock) const noexcept {
    if (nodes_.empty()) {
        return {std::min(clock * speed_, 1.0), speed_, 0.0};
    }
    const auto after =
        std::upper_bound(nodes_.begin() + 1, nodes_.end() - 1, clock,
                         [](double value, const Node& node) { return value < node.clock; });
    const Node& b = *after;
    const Node& a = *(after - 1);
    // The quintic with the speeds and slopes of both nodes.
    const double h = b.clock - a.clock;
    const double u = std::clamp((clock - a.clock) / h, 0.0, 1.0);
    const double v0 = a.s.velocity * h;
    const double v1 = b.s.velocity * h;
    const double a0 = a.s.acceleration * h * h;
    const double a1 = b.s.acceleration * h * h;
    const double rise = b.s.position - a.s.position;
    const double c3 = 10 * rise - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1;
    const double c4 = -15 * rise + 8 * v0 + 7 * v1 + 1.5 * a0 - a1;
    const double c5 = 6 * rise - 3 * (v0 + v1) - 0.5 * (a0 - a1);
    return {a.s.position + u * (v0 + u * (a0 / 2 + u * (c3 + u * (c4 + u * c5)))),
            (v0 + u * (a0 + u * (3 * c3 + u * (4 * c4 + u * 5 * c5)))) / h,
            (a0 + u * (6 * c3 + u * (12 * c4 + u * 20 * c5))) / (h * h)};
}

double SpeedMap::clockAt(double s) const noexcept {
    double low = 0;
    double high = end_;
    constexpr int halvings = 60;  // to the last bit
    for (int i = 0; i < halvings && low < high; ++i) {
        const double middle = low + (high - low) / 2;
        (at(middle).position < s ? low : high) = middle;
    }
    return high;
}

std::vector<SpeedBounds> axisBounds(const RobotModel& model,
                                    const std::vector<JointVector>& knots) {
    SpeedBounds empty;
    empty.count = model.axisCount();
    for (std::size_t i = 0; i < empty.count; ++i) {
        const JointLimits& limits = model.limits(i);
        empty.values[i] = {0, 0, 0, limits.velocity, limits.acceleration, limits.jerk};
    }
    std::vector<SpeedBounds> bounds(knots.size(), empty);
    for (std::size_t i = 0; i < empty.count; ++i) {
        differentiate(knots, i, bounds);
    }
    return bounds;
}

SpeedBottleneck findBottleneck(const RobotModel& model, const std::vector<SpeedBounds>& bounds,
                               double speed) {
    SpeedBottleneck result;
    for (std::size_t k = 0; k < bounds.size(); ++k) {
        for (std::size_t i = 0; i < model.axisCount(); ++i) {
            const SpeedBound& bound = bounds[k].values[i];
            const double allowed = leftFor(bound.velocity, 0, bound.first);
            if (allowed < result.share * speed) {
                result = {allowed / speed, i,
                          static_cast<double>(k) / static_cast<double>(bounds.size() - 1)};
            }
        }
    }
    return result;
}

SpeedPlan planSpeed(const std::vector<SpeedBounds>& bounds, const ScalarLimits& requested) {
    // From rest to rest no more than this is ever reached.
    const double reachable = std::min(requested.velocity, std::sqrt(requested.acceleration));
    SpeedPlan best;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](SpeedPlan plan) {
        const double duration = durationOf(plan);
        if (duration < least) {
            least = duration;
            best = std::move(plan);
        }
    };
    for (const double bend_share : kBendShares) {
        const std::vector<double> caps = speedCaps(bounds, reachable, bend_share);
        const double slowest = *std::min_element(caps.begin(), caps.end());
        const std::vector<SpeedAt> even(caps.size(), SpeedAt{slowest, 0, 0});
        consider({SpeedMap::constant(slowest), clockLimits(bounds, even, requested)});
        if (slowest >= reachable) {
            return best;
        }
        for (const SlopeShares& shares : kSlopeShares) {
            consider(planVarying(bounds, caps, requested, shares));
        }
    }
    return best;
}

}  // namespace metier::motion
