#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "metier/base/numbers.hpp"
#include "metier/motion/planner.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

/// Largest duration of a path, as a multiple of the optimum.
constexpr double kBar = 1.5;

PathWaypoint line(double y, double z, double blend_radius, double max_velocity = 0) {
    PathWaypoint waypoint;
    waypoint.target.translation = {0, y, z};
    waypoint.blend_radius = blend_radius;
    waypoint.max_velocity = max_velocity;
    return waypoint;
}

/// `count` lines of that length, up and aside in turn.
void addStairs(PathRequest& request, int count, double length, double blend_radius) {
    for (int i = 0; i < count; ++i) {
        request.waypoints.push_back(i % 2 == 0 ? line(0, length, blend_radius)
                                               : line(length, 0, blend_radius));
    }
}

/// Shortest traversal of a path from rest to rest by a dense phase plane: velocity and acceleration
/// of every axis and of the tool frame within their limits, and at each place the jerk that its
/// bend takes at that speed. Speeding up and braking takes no time for jerks here: a true optimum
/// takes longer, wherever it does.
///
/// The places are equally far from one another in the time that the plan takes, so that they are
/// dense where it is slow; the derivatives are differences of the plan's positions, not its own.
class PhasePlane {
public:
    PhasePlane(const RobotModel& model, const Trajectory& plan) : model_(model), plan_(plan) {
        std::vector<double> places;
        for (int i = 0; i <= kPlaces; ++i) {
            const double time = i * plan.duration().count() / kPlaces;
            const double s = plan.pathParameter(plan.profile().at(time)).position;
            if (places.empty() || s > places.back() + 1e-9) {
                places.push_back(s);
            }
        }
        for (std::size_t k = 1; k + 1 < places.size(); ++k) {
            add(places[k], std::min(places[k] - places[k - 1], places[k + 1] - places[k]));
        }
    }

    /// [s]
    double time() {
        squares_.assign(places_.size(), 0);
        for (std::size_t k = 0; k < places_.size(); ++k) {
            squares_[k] = fastest(places_[k]);
        }
        squares_.front() = squares_.back() = 0;
        for (std::size_t k = 1; k < places_.size(); ++k) {
            squares_[k] = std::min(squares_[k], reached(k - 1, places_[k].s - places_[k - 1].s));
        }
        for (std::size_t k = places_.size() - 1; k > 0; --k) {
            squares_[k - 1] =
                std::min(squares_[k - 1], reached(k, places_[k].s - places_[k - 1].s));
        }
        double sum = 0;
        for (std::size_t k = 1; k < places_.size(); ++k) {
            sum += 2 * (places_[k].s - places_[k - 1].s) /
                   (std::sqrt(squares_[k - 1]) + std::sqrt(squares_[k]));
        }
        return sum;
    }

private:
    static constexpr int kPlaces = 4000;
    struct Bound {
        double first;
        double second;
        double velocity;
        double acceleration;
    };
    struct Place {
        double s;
        std::vector<Bound> bounds;
    };

    void add(double s, double gap) {
        const double h = std::min(0.5 * gap, 1e-4);
        const JointVector before = plan_.positionAt(s - h);
        const JointVector at = plan_.positionAt(s);
        const JointVector after = plan_.positionAt(s + h);
        const JointVector inner_before = plan_.positionAt(s - h / 3);
        const JointVector inner_after = plan_.positionAt(s + h / 3);
        double cap = kInfinity;
        const double cube = 8.0 / 27 * h * h * h;
        Place place{s, {}};
        for (std::size_t i = 0; i < at.size(); ++i) {
            const JointLimits& own = model_.limits(i);
            place.bounds.push_back({(after[i] - before[i]) / (2 * h),
                                    (after[i] - 2 * at[i] + before[i]) / (h * h), own.velocity,
                                    own.acceleration});
            const double third =
                (after[i] - 3 * inner_after[i] + 3 * inner_before[i] - before[i]) / cube;
            cap = std::min(cap, std::pow(own.jerk / std::abs(third), 2.0 / 3));
        }
        const CartesianLimits& own = model_.cartesianLimits();
        const Eigen::Vector3d a = plan_.poseAt(s - h).translation;
        const Eigen::Vector3d b = plan_.poseAt(s).translation;
        const Eigen::Vector3d c = plan_.poseAt(s + h).translation;
        // The part of the acceleration across the path bounds the speed, that along it its change.
        const Eigen::Vector3d first = (c - a) / (2 * h);
        const Eigen::Vector3d second = (c - 2 * b + a) / (h * h);
        place.bounds.push_back({first.norm(), 0, own.velocity, own.acceleration});
        const Eigen::Vector3d third = (c - 3 * plan_.poseAt(s + h / 3).translation +
                                       3 * plan_.poseAt(s - h / 3).translation - a) /
                                      cube;
        const double across = first.cross(second).norm() / std::max(first.norm(), 1e-12);
        caps_.push_back(
            std::min({cap, own.acceleration / across, std::pow(own.jerk / third.norm(), 2.0 / 3)}));
        places_.push_back(place);
    }

    double fastest(const Place& place) const {
        double z = kInfinity;
        for (const Bound& b : place.bounds) {
            z = std::min(z, std::pow(b.velocity / std::abs(b.first), 2));
        }
        return std::min(z, caps_[static_cast<std::size_t>(&place - places_.data())]);
    }

    /// The largest square of the speed `step` farther.
    double reached(std::size_t k, double step) const {
        double slope = kInfinity;
        for (const Bound& b : places_[k].bounds) {
            const double bend = std::abs(b.second) * squares_[k];
            slope = std::min(slope, (b.acceleration + bend) / std::abs(b.first));
        }
        return squares_[k] + 2 * step * slope;
    }

    const RobotModel& model_;
    const Trajectory& plan_;
    std::vector<Place> places_;
    std::vector<double> caps_;  ///< of the squares, by bends
    std::vector<double> squares_;
};

class PathTimeOf : public EachRobot {
protected:
    PathTimeOf() {
        request_.lin.start = model_.home();
        request_.lin.reference = TargetReference::relative_base;
    }

    /// \param bar how many times the optimum it may take
    void expectNearOptimum(double bar = kBar) {
        const auto plan = Planner(model_).path(request_);
        ASSERT_TRUE(plan) << plan.error().error.message;
        const double optimum = PhasePlane(model_, *plan).time();
        EXPECT_LE(plan->duration().count(), bar * optimum);
        fmt::print("{}: {:.3f} s, optimum {:.3f} s\n", GetParam(), plan->duration().count(),
                   optimum);
    }

    PathRequest request_;
};

INSTANTIATE_TEST_SUITE_P(Robots, PathTimeOf, testing::ValuesIn(kRobots), robotName);

TEST_P(PathTimeOf, ALongLineAndTwentyShortOnesIsNearTheOptimum) {
    request_.waypoints.push_back(line(0.1, 0, 0.00025));
    addStairs(request_, 20, 0.0005, 0.00025);
    expectNearOptimum();
}

TEST_P(PathTimeOf, FiftyFourShortLinesIsNearTheOptimum) {
    constexpr int count = 54;
    const double radius = 0.0013 / 2 / std::sin(std::numbers::pi / count);
    for (int i = 0; i < count; ++i) {
        const double from = 2 * std::numbers::pi * i / count;
        const double to = 2 * std::numbers::pi * (i + 1) / count;
        request_.waypoints.push_back(line(radius * (std::cos(to) - std::cos(from)),
                                          radius * (std::sin(to) - std::sin(from)), 0.0006));
    }
    expectNearOptimum();
}

TEST_P(PathTimeOf, LongAndShortLinesIsNearTheOptimum) {
    request_.waypoints = {line(0.1, 0, 1e-4), line(0, 0.002, 1e-4), line(-0.1, 0, 1e-3),
                          line(0, 0.02, 5e-3), line(0.1, 0, 0)};
    expectNearOptimum();
}

TEST_P(PathTimeOf, TwoLongLinesWithABlendOfAMicrometreIsNearTheOptimum) {
    request_.waypoints = {line(0.1, 0, 1e-6), line(0, 0.1, 0)};
    // The corner is almost a stop, whose jerks the phase plane does not count.
    expectNearOptimum(1.6);
}

TEST_P(PathTimeOf, WithASlowLineTakesThatLinesTimeAndLittleMore) {
    request_.waypoints = {line(0.1, 0, 0.005), line(0, 0.02, 0.005, 0.005), line(-0.1, 0, 0)};
    const auto slow = Planner(model_).path(request_);
    request_.waypoints[1].max_velocity = 0;
    const auto quick = Planner(model_).path(request_);
    ASSERT_TRUE(slow && quick);
    EXPECT_LE(slow->duration().count(), 0.02 / 0.005 + kBar * quick->duration().count());
}

}  // namespace
}  // namespace metier::motion
