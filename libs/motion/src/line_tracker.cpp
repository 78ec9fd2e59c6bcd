#include "line_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "metier/motion/rotation.hpp"

namespace metier::motion {

namespace {

constexpr std::size_t kMostKnots = 4096;
/// Number of knots that is enough to see whether another arm angle helps.
constexpr std::size_t kKnotsToTryWith = 512;
/// A longer step between knots asks for more of them [rad].
constexpr double kJointStep = 0.06;
/// A step that deviates more than this from the one expected by the steps before also asks for more
/// knots [rad].
constexpr double kJointBend = 0.004;
/// A step that stays longer than this, however dense the knots, is a jump [rad].
constexpr double kJump = 0.2;
/// Half way between two knots the joint line may be this far off [m], [rad].
constexpr double kHalfWayDistance = 1e-4;
constexpr double kHalfWayAngle = 1e-3;
constexpr double kNearSingular = 0.02;

struct Track {
    std::vector<JointVector> knots;
    bool too_coarse = false;
    std::optional<Refusal> refusal;
};

Refusal at(double fraction, Refusal refusal) {
    refusal.fraction = fraction;
    refusal.error.message += fmt::format(" at {:.1f} % of the path", 100 * fraction);
    return refusal;
}

std::optional<Refusal> checkLimits(const TrackRequest& request, const JointVector& q) {
    constexpr double rounding = 1e-9;
    for (std::size_t i = 0; i < q.size(); ++i) {
        double lower = request.model->limits(i).lower;
        double upper = request.model->limits(i).upper;
        if (request.bounds.isSet()) {
            lower = std::max(lower, request.bounds.lower[i]);
            upper = std::min(upper, request.bounds.upper[i]);
        }
        if (q[i] >= lower - rounding && q[i] <= upper + rounding) {
            continue;
        }
        const bool over = q[i] > upper;
        return refuse(RefusalReason::joint_limit, Errc::out_of_range,
                      fmt::format("axis {}: {:.4f} rad {} limit {:.4f} rad", i + 1, q[i],
                                  over ? "over" : "under", over ? upper : lower),
                      i);
    }
    return std::nullopt;
}

std::size_t largestStep(const JointVector& from, const JointVector& to) {
    std::size_t axis = 0;
    for (std::size_t i = 1; i < from.size(); ++i) {
        axis = std::abs(to[i] - from[i]) > std::abs(to[axis] - from[axis]) ? i : axis;
    }
    return axis;
}

Refusal jump(const TrackRequest& request, const JointVector& from, const JointVector& to) {
    const std::size_t axis = largestStep(from, to);
    const double smallest = request.model->kinematics().smallestSingularValue(from);
    const std::string what = fmt::format("axis {} would have to turn {:.3f} rad in one place",
                                         axis + 1, std::abs(to[axis] - from[axis]));
    return smallest < kNearSingular
               ? refuse(RefusalReason::singularity, Errc::unreachable,
                        fmt::format("singularity: {}, smallest singular value {:.5f},", what,
                                    smallest),
                        axis)
               : refuse(RefusalReason::configuration_change, Errc::unreachable,
                        "the arm would have to change its configuration: " + what, axis);
}

/// Place at which a path is farthest out of reach, and the first place out of reach.
struct Gap {
    ReachMiss worst;
    double begin = 0;
};

std::optional<ReachMiss> missAt(const TrackRequest& request, double s) {
    return request.model->kinematics().outOfReach(request.path.at(s), request.start);
}

std::optional<Gap> findGap(const TrackRequest& request) {
    constexpr int places = 64;
    std::optional<Gap> gap;
    for (int i = 1; i <= places; ++i) {
        const double s = static_cast<double>(i) / places;
        const auto miss = missAt(request, s);
        if (miss && !gap) {
            gap = Gap{*miss, s};
        } else if (miss && miss->excess() > gap->worst.excess()) {
            gap->worst = *miss;
        }
    }
    double inside = gap ? gap->begin - 1.0 / places : 0;
    for (int i = 0; gap && i < 20; ++i) {
        const double middle = (inside + gap->begin) / 2;
        (missAt(request, middle) ? gap->begin : inside) = middle;
    }
    return gap;
}

tl::unexpected<Refusal> unreachable(std::string_view where, const ReachMiss& miss, double begin) {
    Refusal refusal = refuse(RefusalReason::unreachable, Errc::unreachable,
                             fmt::format("{}: {}, out of reach from {:.1f} % of the path on", where,
                                         toString(miss), 100 * begin));
    refusal.fraction = begin;
    return tl::unexpected(std::move(refusal));
}

/// Refuses a target out of reach before anything is tracked: near the end of its reach an arm is
/// singular, too, but the caller has to know the reach.
Checked refuseUnreachableTarget(const TrackRequest& request) {
    const auto miss = missAt(request, 1.0);
    if (!miss) {
        return {};
    }
    const auto gap = findGap(request);
    return unreachable("target", *miss, gap ? gap->begin : 1.0);
}

/// Follows the branch of the start position knot by knot.
Track follow(const TrackRequest& request, const std::vector<double>& places, bool may_halve) {
    const Kinematics& kinematics = request.model->kinematics();
    Track track;
    track.knots.reserve(places.size());
    track.knots.push_back(request.start);
    JointVector guess = request.start;
    for (std::size_t k = 1; k < places.size(); ++k) {
        const double s = places[k];
        const Pose flange = request.path.at(s);
        const JointVector q = kinematics.solutionNear(flange, guess, request.path.armAngleAt(s));
        const JointVector& last = track.knots.back();
        if (q.empty()) {
            track.refusal = at(s, refuse(RefusalReason::unreachable, Errc::unreachable,
                                         "unreachable: no joint position found"));
            return track;
        }
        const double step = maxDifference(q, last);
        const bool bends = k > 1 && maxDifference(q, guess) > kJointBend;
        if ((step > kJointStep || bends) && may_halve) {
            track.too_coarse = true;
            return track;
        }
        if (step > kJump) {
            track.refusal = at(s, jump(request, last, q));
            return track;
        }
        if (auto refusal = checkLimits(request, q)) {
            track.refusal = at(s, *refusal);
            return track;
        }
        const double longer = k + 1 < places.size() ? (places[k + 1] - s) / (s - places[k - 1]) : 1;
        guess.view() = q.view() + longer * (q.view() - last.view());
        track.knots.push_back(q);
    }
    return track;
}

/// The first knot after which the joint line leaves the path, as a hidden flip would.
std::optional<std::size_t> firstOffPath(const TrackRequest& request,
                                        const std::vector<double>& places,
                                        const std::vector<JointVector>& knots) {
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
        JointVector middle = knots[k];
        middle.view() = 0.5 * (knots[k].view() + knots[k + 1].view());
        const Pose reached = request.model->kinematics().forward(middle);
        const Pose planned = request.path.at((places[k] + places[k + 1]) / 2);
        if (distanceBetween(reached, planned) > kHalfWayDistance ||
            rotationAngleBetween(reached.rotation, planned.rotation) > kHalfWayAngle) {
            return k;
        }
    }
    return std::nullopt;
}

/// The axes turn so quickly that no number of knots shows how.
Refusal tooCurved(double s, const JointVector& from, const JointVector& to) {
    const std::size_t axis = largestStep(from, to);
    return at(s,
              refuse(RefusalReason::singularity, Errc::unreachable,
                     fmt::format("singularity: axis {} cannot follow the path", axis + 1), axis));
}

Planned<JointPath> trackWithArmAngle(const TrackRequest& request, std::size_t most_knots) {
    for (double density = 1; true; density *= 2) {
        std::vector<double> places = request.path.tool.places(density);
        const bool may_halve = 2 * places.size() <= most_knots;
        Track track = follow(request, places, may_halve);
        if (track.refusal) {
            return tl::unexpected(*track.refusal);
        }
        const auto off = track.too_coarse ? 0 : firstOffPath(request, places, track.knots);
        if (!off) {
            return JointPath(request.path, std::move(places), std::move(track.knots),
                             request.model->kinematics());
        }
        if (!may_halve) {
            return tl::unexpected(
                tooCurved(places[*off], track.knots[*off], track.knots[*off + 1]));
        }
    }
}

double shortTurn(double from, double to) {
    return std::remainder(to - from, 2 * std::numbers::pi);
}

/// Keeps the arm angle, or changes it where that is asked for or is the only way.
Planned<JointPath> trackWithSomeArmAngle(const TrackRequest& request) {
    constexpr int tries = 18;
    constexpr double step = std::numbers::pi / tries;
    TrackRequest attempt = request;
    const Kinematics& kinematics = request.model->kinematics();
    attempt.path.arm_angle = kinematics.redundancyAngle(request.start);
    if (request.end_arm_angle) {
        attempt.path.arm_angle_turn = shortTurn(attempt.path.arm_angle, *request.end_arm_angle);
    }
    auto path = trackWithArmAngle(attempt, kMostKnots);
    if (path || request.end_arm_angle || kinematics.ikKind() != IkKind::arm_angle) {
        return path;
    }
    for (int i = 1; i <= tries; ++i) {
        for (const double turn : {i * step, -i * step}) {
            attempt.path.arm_angle_turn = turn;
            if (auto other = trackWithArmAngle(attempt, kKnotsToTryWith)) {
                return other;
            }
        }
    }
    return path;
}

}  // namespace

Planned<JointPath> trackLine(const TrackRequest& request) {
    METIER_TRY(refuseUnreachableTarget(request));
    auto path = trackWithSomeArmAngle(request);
    if (path || path.error().reason == RefusalReason::joint_limit) {
        return path;
    }
    if (const auto gap = findGap(request)) {
        return unreachable("way", gap->worst, gap->begin);
    }
    return path;
}

}  // namespace metier::motion
