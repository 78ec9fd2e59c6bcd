// Cost of kinematics, planning and sampling beside KDL in the same run.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <kdl/chainiksolverpos_lma.hpp>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "../tests/kdl_oracle.hpp"
#include "metier/motion/execution.hpp"
#include "metier/motion/planner.hpp"
#include "metier/motion/stream_follower.hpp"

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
    std::vector<geometry::Pose> poses;
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
        const geometry::Pose& pose = fixture.poses[k % kPositions];
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

void planLine(benchmark::State& state, const std::string& robot) {
    const RobotModel model = load(robot);
    const LinRequest request = line(model, 0.1);
    for (auto _ : state) {
        benchmark::DoNotOptimize(Planner(model).lin(request));
    }
}

void sampleLine(benchmark::State& state, const std::string& robot) {
    const RobotModel model = load(robot);
    const Trajectory trajectory = planLin(model, line(model, 0.1)).value();
    MotionExecution execution(trajectory);
    std::vector<double> costs;
    for (auto _ : state) {
        if (execution.finished()) {
            execution = MotionExecution(trajectory);
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

constexpr std::array<Entry, 10> kEntries{{{"forward", forwardOwn, "forward_kdl"},
                                          {"forward_kdl", forwardKdl, nullptr},
                                          {"forward_and_jacobian", jacobianOwn, "jacobian_kdl"},
                                          {"jacobian_kdl", jacobianKdl, nullptr},
                                          {"inverse_all_solutions", inverseAll, "inverse_kdl_lma"},
                                          {"inverse_nearest", inverseNearest, "inverse_kdl_lma"},
                                          {"inverse_numeric", inverseNumeric, "inverse_kdl_lma"},
                                          {"inverse_kdl_lma", inverseKdl, nullptr},
                                          {"plan_lin", planLine, nullptr},
                                          {"sample_lin", sampleLine, nullptr}}};

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
            benchmark::RegisterBenchmark((std::string(entry.name) + "/" + robot).c_str(), entry.run,
                                         robot);
        }
        benchmark::RegisterBenchmark(("follow_stream/" + robot).c_str(), followStream, robot);
    }
    RatioReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    reporter.printRatios();
}
