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
    std::vector<motion::Pose> poses;
};

void forwardOwn(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    std::size_t n = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            fixture.model.kinematics().forward(fixture.positions[n++ % kPositions]));
    }
}

void forwardKdl(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    KdlOracle oracle(fixture.model.chain());
    std::size_t n = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(oracle.forward(fixture.positions[n++ % kPositions]));
    }
}

void jacobianOwn(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    std::size_t n = 0;
    Jacobian jacobian;
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            fixture.model.kinematics().forward(fixture.positions[n++ % kPositions], jacobian));
    }
}

void jacobianKdl(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    KdlOracle oracle(fixture.model.chain());
    std::size_t n = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(oracle.jacobian(fixture.positions[n++ % kPositions]));
    }
}

void inverseAll(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    std::size_t n = 0;
    for (auto _ : state) {
        const std::size_t k = n++ % kPositions;
        benchmark::DoNotOptimize(
            fixture.model.kinematics().allSolutions(fixture.poses[k], fixture.positions[k]));
    }
}

void inverseNearest(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    std::size_t n = 0;
    std::size_t solved = 0;
    IkRequest request;
    for (auto _ : state) {
        const std::size_t k = n++;
        request.reference = fixture.positions[(k + 7) % kPositions];
        solved +=
            fixture.model.kinematics().inverse(fixture.poses[k % kPositions], request) ? 1 : 0;
    }
    state.counters["solved"] = static_cast<double>(solved) / static_cast<double>(n);
}

void inverseNumeric(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    std::size_t n = 0;
    std::size_t solved = 0;
    IkRequest request;
    for (auto _ : state) {
        const std::size_t k = n++;
        request.reference = fixture.positions[(k + 7) % kPositions];
        solved +=
            fixture.model.kinematics().inverseNumerically(fixture.poses[k % kPositions], request)
                ? 1
                : 0;
    }
    state.counters["solved"] = static_cast<double>(solved) / static_cast<double>(n);
}

void inverseKdl(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    const KdlOracle oracle(fixture.model.chain());
    KDL::ChainIkSolverPos_LMA solver(oracle.chain(), Eigen::Matrix<double, 6, 1>::Ones(), 1e-6, 500,
                                     1e-15);
    const auto axes = static_cast<unsigned>(fixture.model.axisCount());
    KDL::JntArray seed(axes);
    KDL::JntArray found(axes);
    std::size_t n = 0;
    std::size_t solved = 0;
    for (auto _ : state) {
        const std::size_t k = n++;
        for (unsigned i = 0; i < axes; ++i) {
            seed(i) = fixture.positions[(k + 7) % kPositions][i];
        }
        const motion::Pose& pose = fixture.poses[k % kPositions];
        const auto& r = pose.rotation;
        const auto& t = pose.translation;
        const KDL::Frame target(KDL::Rotation::Quaternion(r.x(), r.y(), r.z(), r.w()),
                                {t.x(), t.y(), t.z()});
        solved += solver.CartToJnt(seed, target, found) == 0 ? 1 : 0;
    }
    state.counters["solved"] = static_cast<double>(solved) / static_cast<double>(n);
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
        motion::Pose& pose = joint.parent_from_joint;
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
    const motion::Pose home = model.kinematics().forward(model.home());
    motion::Pose start = home;
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
    KDL::ChainIkSolverPos_LMA solver(oracle.chain(), Eigen::Matrix<double, 6, 1>::Ones(), 1e-6, 500,
                                     1e-15);
    const motion::Pose home = model.kinematics().forward(model.home());
    const auto& r = home.rotation;
    const auto& t = home.translation;
    const KDL::Frame from(KDL::Rotation::Quaternion(r.x(), r.y(), r.z(), r.w()),
                          {t.x(), t.y(), t.z()});
    const KDL::Frame to(from.M, from.p + KDL::Vector(0, 0, 0.1));
    auto profile = std::make_unique<KDL::VelocityProfile_Trap>(0.25, 1.2);
    auto path = std::make_unique<KDL::Path_Line>(
        from, to, new KDL::RotationalInterpolation_SingleAxis(), 0.25);
    profile->SetProfile(0, path->PathLength());
    const double duration = profile->Duration();
    const KDL::Trajectory_Segment trajectory(path.release(), profile.release());
    const auto axes = static_cast<unsigned>(model.axisCount());
    KDL::JntArray q(axes);
    KDL::JntArray next(axes);
    double time = duration;
    for (auto _ : state) {
        time += 0.001;
        if (time > duration) {
            time = 0;
            for (unsigned i = 0; i < axes; ++i) {
                q(i) = model.home()[i];
            }
        }
        benchmark::DoNotOptimize(solver.CartToJnt(q, trajectory.Pos(time), next));
        q = next;
    }
}

void planPtp(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    std::size_t n = 0;
    PtpRequest request;
    for (auto _ : state) {
        request.start = fixture.positions[n % kPositions];
        request.target = fixture.positions[(n + 7) % kPositions];
        ++n;
        benchmark::DoNotOptimize(Planner(fixture.model).ptp(request));
    }
}

void selfCollision(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    const SelfCollision collision(fixture.model);
    std::size_t n = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(collision.nearest(fixture.positions[n++ % kPositions]));
    }
    state.counters["pairs"] = static_cast<double>(collision.pairCount());
}

/// Baseline of selfCollision(): only where the links are.
void linkFramesKdl(benchmark::State& state, const std::string& robot) {
    const Fixture fixture(robot);
    const KdlOracle oracle(fixture.model.chain());
    KDL::ChainFkSolverPos_recursive solver(oracle.chain());
    const auto axes = static_cast<unsigned>(fixture.model.axisCount());
    std::vector<KDL::Frame> frames(oracle.chain().getNrOfSegments());
    KDL::JntArray q(axes);
    std::size_t n = 0;
    for (auto _ : state) {
        for (unsigned i = 0; i < axes; ++i) {
            q(i) = fixture.positions[n % kPositions][i];
        }
        ++n;
        benchmark::DoNotOptimize(solver.JntToCart(q, frames));
    }
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
    const Trajectory trajectory = planLin(model, line(model, 0.1)).value();
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
