// Halt and Suspend of moves that were planned slow, soft or short, at any place: how soon the arm
// stands, beside what its own limits allow. METIER_TEST_SCALE multiplies the number of moves.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "metier/motion/motion_run.hpp"
#include "metier/motion/planner.hpp"
#include "metier/motion/rotation.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

constexpr int kMoves = 1000;

/// Shortest time from velocity `v` and acceleration `a` to rest [s]: the acceleration goes straight
/// to that of braking, stays, and goes back to 0.
double shortestStop(double v, double a, double most_acceleration, double most_jerk) {
    if (v < 0 || (v == 0 && a < 0)) {
        v = -v;
        a = -a;
    }
    const double peak = std::sqrt(std::max(most_jerk * v + a * a / 2, 0.0));  // peak of a triangle
    if (peak <= most_acceleration) {
        return std::abs(a + peak) / most_jerk + peak / most_jerk;
    }
    const double ramps = (a + 2 * most_acceleration) / most_jerk;
    const double taken = (2 * most_acceleration * most_acceleration - a * a) / (2 * most_jerk);
    return ramps + std::max(0.0, v - taken) / most_acceleration;
}

/// A random move of any kind, planned with any limits, and slowed to any duration.
class Moves {
public:
    Moves(const RobotModel& model, unsigned seed) : model_(model), random_(seed) {}

    Trajectory next() {
        for (;;) {
            if (auto plan = attempt()) {
                return stretched(*plan);
            }
        }
    }
    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }

private:
    std::optional<Trajectory> attempt() {
        auto plan = between(0, 1) < 0.4 ? ptp() : path();
        return plan && plan->duration().count() > 0.1 ? std::optional(*plan) : std::nullopt;
    }

    double share() { return between(0, 1) < 0.3 ? 1.0 : std::pow(10.0, between(-2.5, 0)); }

    std::optional<Trajectory> ptp() {
        PtpRequest request;
        request.start = randomPosition(model_, random_);
        request.target = randomPosition(model_, random_);
        request.max_velocity = JointVector(model_.axisCount());
        request.max_acceleration = JointVector(model_.axisCount());
        const double velocity = share();
        const double acceleration = share();
        for (std::size_t i = 0; i < model_.axisCount(); ++i) {
            request.max_velocity[i] = velocity * model_.limits(i).velocity;
            request.max_acceleration[i] = acceleration * model_.limits(i).acceleration;
        }
        request.speed_override = share();
        auto plan = Planner(model_).ptp(request);
        return plan ? std::optional(*plan) : std::nullopt;
    }

    motion::Pose somewhere() {
        const auto vector = [&](double size) {
            Eigen::Vector3d result;
            for (double& value : result) {
                value = between(-size, size);
            }
            return result;
        };
        motion::Pose pose;
        pose.translation = vector(0.2);
        pose.rotation = motion::fromRotationVector(vector(0.4));
        return pose;
    }

    LinRequest line() {
        LinRequest request;
        request.start = model_.home();
        for (double& q : request.start) {
            q += between(-0.3, 0.3);
        }
        const CartesianLimits& own = model_.cartesianLimits();
        const double v = share();
        const double a = share();
        request.max_velocity.fill(v * own.velocity);
        request.max_acceleration.fill(a * own.acceleration);
        request.speed_override = share();
        request.reference = TargetReference::relative_base;
        request.target = somewhere();
        return request;
    }

    std::optional<Trajectory> path() {
        if (between(0, 1) < 0.7) {
            auto plan = Planner(model_).lin(line());
            return plan ? std::optional(*plan) : std::nullopt;
        }
        PathRequest request{line(), {}};
        for (int i = 0; i < 3; ++i) {
            request.waypoints.push_back(
                {.target = somewhere(), .blend_radius = 0.02, .max_velocity = 0});
        }
        auto plan = Planner(model_).path(request);
        return plan ? std::optional(*plan) : std::nullopt;
    }

    Trajectory stretched(const Trajectory& plan) {
        return between(0, 1) < 0.5
                   ? plan
                   : plan.stretchedTo(plan.duration() * std::pow(10.0, between(0, 2)));
    }

    const RobotModel& model_;
    std::mt19937_64 random_;
};

/// Way in which a motion came to rest.
struct Stop {
    double time = 0;       ///< [s]
    double possible = 0;   ///< shortest time that the limits of axes and tool frame allow [s]
    double announced = 0;  ///< time that stoppingEstimate() announced before [s]
    double farther = 0;    ///< beyond the distance that stoppingEstimate() said [m]
};

class StoppingOf : public EachRobot {
protected:
    /// Shortest time to rest by the robot's own limits from here: each axis by itself, and the tool
    /// frame's speed along its path.
    double possible(const Trajectory& plan, const MotionRun& execution) const {
        const SetPoint& now = execution.current();
        double longest = 0;
        for (std::size_t i = 0; i < now.position.size(); ++i) {
            const JointLimits& own = model_.limits(i);
            longest = std::max(longest, shortestStop(now.velocity[i], now.acceleration[i],
                                                     own.acceleration, own.jerk));
        }
        if (plan.length() > 0) {
            const double speed = toolSpeed(plan, execution);
            const CartesianLimits& own = model_.cartesianLimits();
            longest = std::max(longest, shortestStop(speed, 0, own.acceleration, own.jerk));
        }
        return longest;
    }

    double toolSpeed(const Trajectory& plan, const MotionRun& execution) const {
        MotionRun later = execution;
        constexpr double step = 1e-5;
        later.next(Seconds(step));
        return motion::distanceBetween(plan.toolPose(execution.current().position),
                                       plan.toolPose(later.current().position)) /
               step;
    }

    /// Lets it come to rest; checks that it stays on its path and within `factor` of the limits.
    /// \param taken the time that it took [s]
    void comeToRest(const Trajectory& plan, MotionRun& execution, double factor,
                    double& taken) const {
        const Seconds step(model_.cycleTime() / 4);
        JointVector before = execution.current().velocity;
        for (taken = 0; !execution.atRest(); taken += step.count()) {
            ASSERT_LT(taken, 10.0);
            const SetPoint now = execution.next(step);
            ASSERT_LE(
                poseError(plan.toolPose(now.position), plan.poseAt(execution.pathParameter())),
                1e-8);
            for (std::size_t axis = 0; axis < now.position.size(); ++axis) {
                const JointLimits& own = model_.limits(axis);
                ASSERT_LE(std::abs(now.velocity[axis] - before[axis]) / step.count(),
                          1.02 * factor * own.acceleration + 1e-6)
                    << "axis " << axis + 1;
                ASSERT_LE(std::abs(now.velocity[axis]), 1.02 * own.velocity);
            }
            before = now.velocity;
        }
    }

    Stop stopped(const Trajectory& plan, MotionRun& execution, void (MotionRun::*how)(),
                 double factor) const {
        Stop stop;
        const StoppingEstimate way = execution.stoppingEstimate();
        stop.announced = way.time.count();
        stop.possible = possible(plan, execution);
        const auto from = plan.toolPose(execution.current().position);
        (execution.*how)();
        comeToRest(plan, execution, factor, stop.time);
        const auto to = plan.toolPose(execution.current().position);
        stop.farther = motion::distanceBetween(from, to) - way.distance;
        return stop;
    }

    /// The shortest stop from `path` on the path whose set-points keep the robot's own limits: the
    /// quickest of many, each looked at in small steps [s].
    double shortestOnPath(const Trajectory& plan, const ScalarState& path) const {
        double shortest = 10.0;
        for (double acceleration = 0.02; acceleration < 200; acceleration *= 1.25) {
            for (double jerk = acceleration; jerk < 1000 * acceleration; jerk *= 1.25) {
                const Profile profile = Profile::brake(path, {1, acceleration, jerk});
                if (profile.end() <= 1.0 && profile.duration() < shortest &&
                    keepsLimits(plan, profile)) {
                    shortest = profile.duration();
                }
            }
        }
        return shortest;
    }

    bool keepsLimits(const Trajectory& plan, const Profile& profile) const {
        constexpr int steps = 50;
        const double step = profile.duration() / steps;
        std::array<JointVector, 4> q;
        for (int i = 0; i <= steps; ++i) {
            std::shift_left(q.begin(), q.end(), 1);
            q.back() = plan.sampleOnPath(profile.at(i * step)).position;
            for (std::size_t axis = 0; i >= 3 && axis < q[0].size(); ++axis) {
                const JointLimits& own = model_.limits(axis);
                const double second = q[3][axis] - 2 * q[2][axis] + q[1][axis];
                const double third = second - (q[2][axis] - 2 * q[1][axis] + q[0][axis]);
                if (std::abs(second) > own.acceleration * step * step ||
                    std::abs(third) > own.jerk * step * step * step) {
                    return false;
                }
            }
        }
        return true;
    }

    /// Checks the time of a stop: near what the axes by themselves would need or, where the path is
    /// what takes longer, the shortest on the path.
    void checkTime(const Trajectory& plan, const ScalarState& from, Stop& stop) const {
        const double most = 2 * model_.cycleTime();
        if (stop.time > 1.2 * stop.possible + most) {
            stop.possible = shortestOnPath(plan, from);
        }
        EXPECT_LE(stop.time, 1.2 * stop.possible + most);
    }

    static double excess(const Stop& stop, double cycle) {
        return (stop.time - 2 * cycle) / stop.possible - 1;
    }

    /// The clock of a motion that runs as planned.
    static ScalarState timeOf(const Trajectory& plan, const MotionRun& execution) {
        return plan.profile().at(plan.profile().duration() - execution.remaining().count());
    }

    /// Runs a random move to a random place.
    MotionRun onTheWay(const Trajectory& plan, Moves& moves) const {
        MotionRun execution(plan);
        execution.next(moves.between(0, 0.999) * plan.duration());
        return execution;
    }
};

INSTANTIATE_TEST_SUITE_P(Robots, StoppingOf, testing::ValuesIn(kRobots), robotName);

TEST_P(StoppingOf, HaltTakesWhatTheRobotNeedsHoweverSlowThePlan) {
    Moves moves(model_, 7);
    double largest = -1;
    for (int i = 0; i < scaled(kMoves) && !HasFailure(); ++i) {
        SCOPED_TRACE(i);
        const Trajectory plan = moves.next();
        MotionRun execution = onTheWay(plan, moves);
        const ScalarState from = plan.pathParameter(timeOf(plan, execution));
        Stop stop = stopped(plan, execution, &MotionRun::halt, 2.0);
        checkTime(plan, from, stop);
        EXPECT_LE(stop.time, stop.announced + model_.cycleTime());
        EXPECT_LE(stop.farther, 1e-9);
        largest = std::max(largest, excess(stop, model_.cycleTime()));
    }
    fmt::print("Halt of {}: at most {:+.1f} % beside the time that its own limits allow\n",
               GetParam(), 100 * largest);
}

TEST_P(StoppingOf, SuspendTakesWhatTheRobotNeedsOrHalfASecond) {
    Moves moves(model_, 8);
    double largest = -1;
    for (int i = 0; i < scaled(kMoves) && !HasFailure(); ++i) {
        SCOPED_TRACE(i);
        const Trajectory plan = moves.next();
        MotionRun execution = onTheWay(plan, moves);
        const ScalarState from = plan.pathParameter(timeOf(plan, execution));

        Stop stop = stopped(plan, execution, &MotionRun::stop, 1.0);
        if (stop.time > MotionRun::kGentleStop.count() + model_.cycleTime()) {
            checkTime(plan, from, stop);
            largest = std::max(largest, excess(stop, model_.cycleTime()));
        }
        execution.resume();
        execution.next(execution.remaining() + Seconds(1e-6));
        EXPECT_TRUE(execution.finished());
        EXPECT_LE(maxDifference(execution.current().position, plan.end()), 1e-12);
    }
    fmt::print("Suspend of {}: at most {:+.1f} % beside that time, where it takes over 0.5 s\n",
               GetParam(), 100 * largest);
}

TEST_P(StoppingOf, HaltIsHarderThanSuspendAndSuspendMayTurnIntoIt) {
    Moves moves(model_, 9);
    for (int i = 0; i < scaled(100); ++i) {
        const Trajectory plan = moves.next();
        MotionRun suspended = onTheWay(plan, moves);
        if (suspended.stoppingEstimate().time < Seconds(0.02)) {
            continue;
        }
        MotionRun halted = suspended;
        suspended.stop();
        halted.halt();
        EXPECT_LT(halted.remaining(), 0.95 * suspended.remaining()) << "move " << i;
        const Seconds all = suspended.remaining();
        suspended.next(0.2 * all);
        suspended.halt();
        EXPECT_LE(suspended.remaining(), 0.8 * all) << "move " << i;
        double taken = 0;
        comeToRest(plan, suspended, 2.0, taken);
    }
}

TEST_P(StoppingOf, AMotionThatIsResumedWhileItBrakesStaysOnItsPath) {
    Moves moves(model_, 10);
    for (int i = 0; i < scaled(200); ++i) {
        const Trajectory plan = moves.next();
        MotionRun execution = onTheWay(plan, moves);
        execution.halt();
        execution.next(moves.between(0, 1) * execution.remaining());
        const JointVector there = execution.current().position;
        execution.resume();
        execution.next(Seconds(1e-6));
        ASSERT_LE(maxDifference(execution.current().position, there), 1e-5) << "move " << i;
        execution.next(execution.remaining() + Seconds(1e-6));
        ASSERT_TRUE(execution.finished()) << "move " << i;
        ASSERT_LE(maxDifference(execution.current().position, plan.end()), 1e-12);
    }
}

TEST_P(StoppingOf, ASlowPtpStandsAfterMilliseconds) {
    PtpRequest request;
    request.start = model_.home();
    JointVector target = model_.home();
    target[0] += 1.0;
    request.target = target;
    const Trajectory plan = Planner(model_).ptp(request).value().stretchedTo(Seconds(60));
    MotionRun execution(plan);
    execution.next(Seconds(30));
    EXPECT_GT(execution.stoppingEstimate().time, Seconds(0));
    EXPECT_GT(execution.stoppingEstimate().distance, 0.0);
    EXPECT_LT(execution.stoppingEstimate().distance, 0.01);  // not the way that is left
    const double speed = execution.current().velocity[0];
    const JointLimits& own = model_.limits(0);
    execution.halt();
    EXPECT_LT(execution.remaining().count(), shortestStop(speed, 0, own.acceleration, own.jerk));
    EXPECT_LT(execution.remaining().count(), 0.1);
    EXPECT_EQ(MotionRun(plan).stoppingEstimate().time, Seconds(0));
}

}  // namespace
}  // namespace metier::motion
