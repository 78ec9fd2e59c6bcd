// A move whose set-points are streamed, as those of a move component, and that is stopped on its
// way: how soon the arm behind the stream stands, and whether it stays on the path.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "bench.hpp"
#include "metier/motion/planner.hpp"
#include "moves/stop_time.hpp"

namespace metier::robot_skills {
namespace {

using motion::JointVector;
using motion::MotionRun;
using motion::Seconds;
using skill::State;

constexpr double kOnThePath = 1e-5;  // [rad]
// As long as no client is asked for another play-out delay: 20 ms, at least three cycles.
constexpr double kPlayOut = 0.02;
constexpr double kLeastPlayOut = 3;
constexpr double kRounding = 1e-6;

class StoppedMoveOverAStreamOf : public ::testing::TestWithParam<std::string> {
protected:
    StoppedMoveOverAStreamOf() : bench_(GetParam()) {}

    /// All axes, the first one at its velocity limit for a while.
    motion::Trajectory plan() const {
        motion::PtpRequest request;
        request.start = bench_.commanded();
        auto target = request.start;
        for (std::size_t axis = 0; axis < target.size(); ++axis) {
            target[axis] += axis == 0 ? 1.5 : 0.3 / static_cast<double>(axis);
        }
        request.target = target;
        return motion::Planner(bench_.model()).ptp(request).value();
    }

    /// Streams one set-point and lets the arm make one cycle.
    void send(MotionRun& execution) {
        const auto next = execution.next(Seconds(cycle_)).position;
        sent_.emplace_back(next.begin(), next.end());
        ASSERT_TRUE(program_.write(bench_.caller(), "TargetJointPosition", sent_.back(), {}));
        bench_.step();
        ASSERT_EQ(program_.state(), State::running) << program_.reasonText();
        const auto now = bench_.commanded();
        played_.emplace_back(now.begin(), now.end());
    }

    /// Stops a move at a share of its duration, and checks that the arm makes just the same motion
    /// a play-out delay later.
    void expectTheSameMotionLater(double share, const std::function<void(MotionRun&)>& stop) {
        ASSERT_TRUE(bench_.start(kPositionStream, {}));
        const auto trajectory = plan();
        MotionRun execution(trajectory);
        for (double time = 0; time < share * trajectory.duration().count(); time += cycle_) {
            ASSERT_NO_FATAL_FAILURE(send(execution));
        }
        stop(execution);
        while (!execution.atRest()) {
            ASSERT_NO_FATAL_FAILURE(send(execution));
        }
        const auto later = static_cast<std::size_t>(
            std::max(kLeastPlayOut, std::ceil(kPlayOut / cycle_ - kRounding)));
        for (std::size_t cycle = 0; cycle < later; ++cycle) {
            ASSERT_NO_FATAL_FAILURE(send(execution));
        }
        for (std::size_t i = later; i < played_.size(); ++i) {
            for (std::size_t axis = 0; axis < played_[i].size(); ++axis) {
                ASSERT_NEAR(played_[i][axis], sent_[i - later][axis], kOnThePath)
                    << "set-point " << i << " of " << played_.size() << ", axis " << axis + 1;
            }
        }
    }

    Bench bench_;
    skill::Program& program_ = bench_.program(kPositionStream);
    const double cycle_ = bench_.arm().info().cycleSeconds();
    std::vector<std::vector<double>> sent_;
    std::vector<std::vector<double>> played_;
};

INSTANTIATE_TEST_SUITE_P(Robots, StoppedMoveOverAStreamOf, testing::Values("ur5", "iiwa7", "edo"),
                         [](const auto& robot) { return robot.param; });

TEST_P(StoppedMoveOverAStreamOf, StandsAPlayOutDelayLaterIfItIsHaltedAtFullSpeed) {
    expectTheSameMotionLater(0.5, [](MotionRun& execution) { execution.halt(); });
}

TEST_P(StoppedMoveOverAStreamOf, StandsAPlayOutDelayLaterIfItIsHaltedWhileItSpeedsUp) {
    expectTheSameMotionLater(0.2, [](MotionRun& execution) { execution.halt(); });
}

TEST_P(StoppedMoveOverAStreamOf, StandsAPlayOutDelayLaterIfItIsHaltedWhileItSlowsDown) {
    expectTheSameMotionLater(0.8, [](MotionRun& execution) { execution.halt(); });
}

TEST_P(StoppedMoveOverAStreamOf, StandsAPlayOutDelayLaterIfItIsSuspended) {
    expectTheSameMotionLater(0.5, [](MotionRun& execution) { execution.stop(); });
}

TEST_P(StoppedMoveOverAStreamOf, StandsAPlayOutDelayLaterIfItIsSuspendedInItsStopTime) {
    const double length = stopTimeFor(plan(), bench_.model(), 0.01);
    ASSERT_GT(length, 0.01);
    expectTheSameMotionLater(0.5, [&](MotionRun& execution) { execution.stopIn(Seconds(length)); });
}

/// Distance of a joint position from the straight line of a PTP, of the axis that is farthest off.
double offLine(const motion::Trajectory& line, const JointVector& q) {
    const auto from = line.start();
    const auto to = line.end();
    const double done = (q[0] - from[0]) / (to[0] - from[0]);
    double farthest = 0.0;
    for (std::size_t axis = 0; axis < q.size(); ++axis) {
        const double planned = from[axis] + done * (to[axis] - from[axis]);
        farthest = std::max(farthest, std::abs(q[axis] - planned));
    }
    return farthest;
}

class BrakingStreamOf : public StoppedMoveOverAStreamOf {
protected:
    /// Streams half of a move, which is at full speed then.
    void streamHalf() {
        ASSERT_TRUE(bench_.start(kPositionStream, {}));
        MotionRun execution(trajectory_);
        while (execution.remaining() > trajectory_.duration() / 2) {
            ASSERT_NO_FATAL_FAILURE(send(execution));
        }
    }
    /// Lets it come to rest, and checks that it does so on its line and as soon as its limits
    /// allow. \param most it may take before it begins to brake [s]
    void expectRestOnItsLine(double most) {
        const auto& limits = bench_.model().limits(0);
        const double speed = std::abs(played_.back()[0] - played_[played_.size() - 2][0]) / cycle_;
        const double needed = speed / limits.acceleration + limits.acceleration / limits.jerk;
        auto before = bench_.commanded();
        double moved = 0.0;  // time of its last movement [s]
        for (double time = cycle_; program_.state() == State::running; time += cycle_) {
            bench_.step();
            const auto now = bench_.commanded();
            ASSERT_LE(offLine(trajectory_, now), 1e-3) << "after " << time << " s";
            moved = motion::maxDifference(now, before) > 1e-9 ? time : moved;
            before = now;
        }
        EXPECT_LE(moved, most + needed + 2 * cycle_);
        EXPECT_EQ(program_.state(), State::halted);
    }

    const motion::Trajectory trajectory_ = plan();
};

INSTANTIATE_TEST_SUITE_P(Robots, BrakingStreamOf, testing::Values("ur5", "iiwa7", "edo"),
                         [](const auto& robot) { return robot.param; });

TEST_P(BrakingStreamOf, StaysOnItsLineIfAnotherClientHaltsIt) {
    ASSERT_NO_FATAL_FAILURE(streamHalf());
    ASSERT_TRUE(program_.halt(bench_.caller()));
    expectRestOnItsLine(0.0);
}

TEST_P(BrakingStreamOf, StaysOnItsLineIfItsClientDies) {
    ASSERT_NO_FATAL_FAILURE(streamHalf());
    expectRestOnItsLine(std::max(kPlayOut, kLeastPlayOut * cycle_));
}

}  // namespace
}  // namespace metier::robot_skills
