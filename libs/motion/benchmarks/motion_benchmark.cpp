// Cost of kinematics, planning and sampling beside KDL in the same run.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/path_line.hpp>
#include <kdl/rotational_interpolation_sa.hpp>
#include <kdl/trajectory_segment.hpp>
#include <kdl/velocityprofile_trap.hpp>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "../tests/kdl_oracle.hpp"
#include "metier/motion/force_limit.hpp"
#include "metier/motion/motion_run.hpp"
#include "metier/motion/planner.hpp"
#include "metier/motion/stream_follower.hpp"
#include "self_collision.hpp"

namespace metier::motion {
namespace {

constexpr std::size_t kPositions = 1024;

RobotModel load(const std::string& robot) {
    return RobotModel::load(std::string(METIER_MODELS_DIR) + "/" + robot + ".toml").value();
}

/// A robot with random positions inside its limits and their poses.
struct Fixture {
    explicit Fixture(const std::string& robot) : model(load(robot)) {
        std::mt19937_64 random(1);
        for (std::size_t n = 0; n < kPositions; ++n) {
            JointVector q(model.axisCount());
            for (std::size_t i = 0; i < q.size(); ++i) {
                const double lower = std::max(model.limits(i).lower, -std::numbers::pi);
                const double upper = std::min(model.limits(i).upper, std::numbers::pi);
                q[i] = std::uniform_real_distribution<double>(lower, upper)(random);
            }
            positions.push_back(q);
            poses.push_back(model.kinematics().forward(q));
        }
    }

    RobotModel model;
    std::vector<JointVector> positions;
    std::vector<Pose> poses;
};

/// Runs `work` with the number of one position after the other.
template <typename Work>
void forEachPosition(benchmark::State& state, const Work& work) {
    std::size_t n = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(work(n++ % kPositions));
    }
}

/// Runs `solve` for the pose at one position after the other, from another position; notes the
/// share of poses for which it succeeds.
template <typename Solve>
void solveEachPose(benchmark::State& state, const Fixture& fixture, const Solve& solve) {
    std::size_t n = 0;
    std::size_t solved = 0;
    for (auto _ : state) {
        const std::size_t k = n++ % kPositions;
        solved += solve(fixture.poses[k], fixture.positions[(k + 7) % kPositions]) ? 1 : 0;
    }
    state.counters["solved"] = static_cast<double>(solved) / static_cast<double>(n);
}

void copyTo(KDL::JntArray& array, const JointVector& joints) {
    for (unsigned i = 0; i < joints.size(); ++i) {
        array(i) = joints[i];
    }
}

KDL::Frame toKdl(const Pose& pose) {
    const auto& r = pose.rotation;
    const auto& t = pose.translation;
    return {KDL::Rotation::Quaternion(r.x(), r.y(), r.z(), r.w()), {t.x(), t.y(), t.z()}};
}

KDL::ChainIkSolverPos_LMA solverOf(const KdlOracle& oracle) {
    return {oracle.chain(), Eigen::Matrix<double, 6, 1>::Ones(), 1e-6, 500, 1e-15};
}

void forwardOwn(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    forEachPosition(state, [&](std::size_t n) {
        return fixture.model.kinematics().forward(fixture.positions[n]);
    });
}

void forwardKdl(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    KdlOracle oracle(fixture.model.chain());
    forEachPosition(state, [&](std::size_t n) { return oracle.forward(fixture.positions[n]); });
}

void jacobianOwn(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    Jacobian jacobian;
    forEachPosition(state, [&](std::size_t n) {
        return fixture.model.kinematics().forward(fixture.positions[n], jacobian);
    });
}

void jacobianKdl(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    KdlOracle oracle(fixture.model.chain());
    forEachPosition(state, [&](std::size_t n) { return oracle.jacobian(fixture.positions[n]); });
}

void inverseAll(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    forEachPosition(state, [&](std::size_t n) {
        return fixture.model.kinematics().allSolutions(fixture.poses[n], fixture.positions[n]);
    });
}

void inverseNearest(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    solveEachPose(state, fixture, [&](const Pose& pose, const JointVector& from) {
        return fixture.model.kinematics().inverse(pose, {from, {}, {}}).has_value();
    });
}

void inverseNumeric(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    solveEachPose(state, fixture, [&](const Pose& pose, const JointVector& from) {
        return fixture.model.kinematics().inverseNumerically(pose, {from, {}, {}}).has_value();
    });
}

void inverseKdl(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    const KdlOracle oracle(fixture.model.chain());
    auto solver = solverOf(oracle);
    KDL::JntArray seed(static_cast<unsigned>(fixture.model.axisCount()));
    KDL::JntArray found(seed);
    solveEachPose(state, fixture, [&](const Pose& pose, const JointVector& from) {
        copyTo(seed, from);
        return solver.CartToJnt(seed, toKdl(pose), found) == 0;
    });
}

LinRequest line(const RobotModel& model, double length) {
    LinRequest request;
    request.start = model.home();
    request.reference = TargetReference::relative_base;
    request.target.translation = {0, 0, length};
    request.max_velocity = {0.25, 0.25, 0.25, 1, 1, 1};
    return request;
}

/// The arm with every length off by 1 mm and every angle by 1 mrad, as a measured one.
RobotModel calibrated(const RobotModel& nominal) {
    ChainDescription chain = nominal.chain();
    double sign = 1;
    for (JointDescription& joint : chain.joints) {
        Pose& pose = joint.parent_from_joint;
        pose.translation += sign * Eigen::Vector3d(1e-3, 0, 1e-3);
        pose.rotation = pose.rotation * Eigen::AngleAxisd(sign * 1e-3, Eigen::Vector3d::UnitX());
        sign = -sign;
    }
    return RobotModel::fromChain(chain).value();
}

void inverseCalibrated(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    const RobotModel arm = calibrated(fixture.model);
    std::size_t n = 0;
    std::size_t found = 0;
    for (auto _ : state) {
        const std::size_t k = n++ % kPositions;
        found += arm.kinematics().allSolutions(fixture.poses[k], fixture.positions[k]).size();
    }
    state.counters["solutions"] = static_cast<double>(found) / static_cast<double>(n);
    state.counters["calibrated"] = arm.kinematics().isCalibrated() ? 1 : 0;
}

/// A line of 1 m that the arm can run, slowly where an axis limits.
LinRequest longLine(const RobotModel& model) {
    LinRequest request = line(model, 0);
    const double half = model.kinematics().reach() > 1 ? 0.5 : 0.3;
    const Pose home = model.kinematics().forward(model.home());
    Pose start = home;
    start.translation.y() -= half;
    request.start = model.kinematics().inverse(start, {model.home(), {}, {}}).value();
    request.target.translation = {0, 2 * half, 0};
    return request;
}

void planLongLine(benchmark::State& state, const std::string& robot) {
    const RobotModel model = load(robot);
    const LinRequest request = longLine(model);
    const auto plan = Planner(model).lin(request);
    if (!plan) {
        state.SkipWithError(plan.error().error.message.c_str());
        return;
    }
    for (auto _ : state) {
        benchmark::DoNotOptimize(Planner(model).lin(request));
    }
    state.counters["length_m"] = plan->length();
}

void planLine(benchmark::State& state, const std::string& robot) {
    const RobotModel model = load(robot);
    const LinRequest request = line(model, 0.1);
    for (auto _ : state) {
        benchmark::DoNotOptimize(Planner(model).lin(request));
    }
}

/// Time of KDL for a set-point of the same line: position on it, and LMA from the set-point before.
void sampleLineKdl(benchmark::State& state, const std::string& robot) {
    const RobotModel model = load(robot);
    const KdlOracle oracle(model.chain());
    auto solver = solverOf(oracle);
    const KDL::Frame from = toKdl(model.kinematics().forward(model.home()));
    const KDL::Frame to(from.M, from.p + KDL::Vector(0, 0, 0.1));
    auto profile = std::make_unique<KDL::VelocityProfile_Trap>(0.25, 1.2);
    auto path = std::make_unique<KDL::Path_Line>(
        from, to, new KDL::RotationalInterpolation_SingleAxis(), 0.25);
    profile->SetProfile(0, path->PathLength());
    const double duration = profile->Duration();
    const KDL::Trajectory_Segment trajectory(path.release(), profile.release());
    KDL::JntArray q(static_cast<unsigned>(model.axisCount()));
    KDL::JntArray next(q);
    double time = duration;
    for (auto _ : state) {
        time += 0.001;
        if (time > duration) {
            time = 0;
            copyTo(q, model.home());
        }
        benchmark::DoNotOptimize(solver.CartToJnt(q, trajectory.Pos(time), next));
        q = next;
    }
}

void planPtp(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    PtpRequest request;
    forEachPosition(state, [&](std::size_t n) {
        request.start = fixture.positions[n];
        request.target = fixture.positions[(n + 7) % kPositions];
        return Planner(fixture.model).ptp(request);
    });
}

void selfCollision(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    const SelfCollision collision(fixture.model);
    forEachPosition(state, [&](std::size_t n) { return collision.nearest(fixture.positions[n]); });
    state.counters["pairs"] = static_cast<double>(collision.pairCount());
}

/// Baseline of selfCollision(): only where the links are.
void linkFramesKdl(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    const KdlOracle oracle(fixture.model.chain());
    KDL::ChainFkSolverPos_recursive solver(oracle.chain());
    std::vector<KDL::Frame> frames(oracle.chain().getNrOfSegments());
    KDL::JntArray q(static_cast<unsigned>(fixture.model.axisCount()));
    forEachPosition(state, [&](std::size_t n) {
        copyTo(q, fixture.positions[n]);
        return solver.JntToCart(q, frames);
    });
}

void checkForce(benchmark::State& state, const std::string& robot) {
    ForceLimit limit =
        ForceLimit::create({50, 5, {0, 0, 40, 0, 0, 0}}, Seconds(load(robot).cycleTime())).value();
    int n = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(limit.check({{0, 0, 0.1 * (n++ % 300)}, {0, 0, 0}}));
    }
}

void sampleLine(benchmark::State& state, const std::string& robot) {
    const RobotModel model = load(robot);
    const Trajectory trajectory = Planner(model).lin(line(model, 0.1)).value();
    MotionRun execution(trajectory);
    std::vector<double> costs;
    for (auto _ : state) {
        if (execution.finished()) {
            execution = MotionRun(trajectory);
        }
        const auto begin = std::chrono::steady_clock::now();
        benchmark::DoNotOptimize(execution.next(Seconds(0.001)));
        costs.push_back(
            std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin)
                .count());
    }
    std::sort(costs.begin(), costs.end());
    state.counters["p99_us"] = costs[costs.size() * 99 / 100];
}

void followStream(benchmark::State& state, const std::string& robot) {
    const RobotModel model = load(robot);
    const Seconds cycle(model.cycleTime());
    StreamFollower follower = StreamFollower::create(model, {cycle}, model.home()).value();
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> noise(-1e-3, 1e-3);
    int n = 0;
    for (auto _ : state) {
        JointVector q = model.home();
        q[0] += noise(random);
        const Seconds now = n++ * cycle;
        benchmark::DoNotOptimize(follower.accept(q, now, now));
        benchmark::DoNotOptimize(follower.next(now));
    }
}

using Run = void (*)(benchmark::State&, const std::string&);
struct Entry {
    const char* name;
    Run run;
    const char* beside;  ///< KDL's row this one is compared with
};

constexpr std::array<Entry, 17> kEntries{
    {{"forward", forwardOwn, "forward_kdl"},
     {"forward_kdl", forwardKdl, nullptr},
     {"forward_and_jacobian", jacobianOwn, "jacobian_kdl"},
     {"jacobian_kdl", jacobianKdl, nullptr},
     {"inverse_all_solutions", inverseAll, "inverse_kdl_lma"},
     {"inverse_nearest", inverseNearest, "inverse_kdl_lma"},
     {"inverse_numeric", inverseNumeric, "inverse_kdl_lma"},
     {"inverse_kdl_lma", inverseKdl, nullptr},
     {"inverse_all_calibrated", inverseCalibrated, "inverse_kdl_lma"},
     {"plan_ptp", planPtp, nullptr},
     {"plan_lin", planLine, nullptr},
     {"plan_lin_1m", planLongLine, nullptr},
     {"sample_lin", sampleLine, "sample_lin_kdl"},
     {"sample_lin_kdl", sampleLineKdl, nullptr},
     {"self_collision", selfCollision, "link_frames_kdl"},
     {"link_frames_kdl", linkFramesKdl, nullptr},
     {"force_check", checkForce, nullptr}}};

/// Prints as the console does and keeps the times for the ratios at the end.
class RatioReporter : public benchmark::ConsoleReporter {
public:
    void ReportRuns(const std::vector<Run>& runs) override {
        ConsoleReporter::ReportRuns(runs);
        for (const Run& run : runs) {
            times_[run.benchmark_name()] = run.GetAdjustedCPUTime();
        }
    }

    void printRatios() const {
        for (const std::string robot : {"ur5", "iiwa7", "edo"}) {
            for (const Entry& entry : kEntries) {
                const auto own = times_.find(std::string(entry.name) + "/" + robot);
                if (entry.beside == nullptr || own == times_.end()) {
                    continue;
                }
                const auto kdl = times_.find(std::string(entry.beside) + "/" + robot);
                if (kdl != times_.end()) {
                    std::printf("%-6s %-22s %6.1f times as fast as %s\n", robot.c_str(), entry.name,
                                kdl->second / own->second, entry.beside);
                }
            }
        }
    }

private:
    std::map<std::string, double> times_;
};

}  // namespace
}  // namespace metier::motion

int main(int argc, char** argv) {
    using namespace metier::motion;
    benchmark::Initialize(&argc, argv);
    for (const std::string robot : {"ur5", "iiwa7", "edo"}) {
        for (const Entry& entry : kEntries) {
            if (entry.run == inverseCalibrated && robot != "ur5") {
                continue;  // the others have no closed form to start from then
            }
            benchmark::RegisterBenchmark((std::string(entry.name) + "/" + robot).c_str(), entry.run,
                                         robot);
        }
        benchmark::RegisterBenchmark(("follow_stream/" + robot).c_str(), followStream, robot);
    }
    RatioReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    reporter.printRatios();
}
