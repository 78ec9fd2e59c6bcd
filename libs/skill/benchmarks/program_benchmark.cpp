// Cost of a Program by itself: run with --benchmark_min_time=1.
#include <benchmark/benchmark.h>

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "metier/skill/lambda_skill.hpp"
#include "metier/skill/program.hpp"

namespace metier::skill {
namespace {

/// Keeps what is posted until it is asked to run it; no thread, no time.
class StepExecutor final : public Executor {
public:
    void post(std::function<void()> work) override { posted_.push_back(std::move(work)); }
    Timer after(std::chrono::nanoseconds /*delay*/, std::function<void()> /*work*/) override {
        return Timer{};
    }
    void run() {
        for (std::size_t i = 0; i < posted_.size(); ++i) {
            std::exchange(posted_[i], nullptr)();
        }
        posted_.clear();
    }

private:
    std::vector<std::function<void()>> posted_;
};

/// Start, and the skill finishes at once.
void startAndFinish(benchmark::State& state) {
    const SystemClock clock;
    const auto executor = std::make_shared<StepExecutor>();
    Program program({}, std::make_unique<LambdaSkill>(SkillDescription{}, SkillFunctions{}),
                    executor, clock);
    const Caller caller{"a session id of usual length", "client", "user"};
    for (auto _ : state) {
        benchmark::DoNotOptimize(program.start(caller));
        executor->run();
    }
}
BENCHMARK(startAndFinish);

/// The same with a parameter written before and a result.
void writeStartAndFinish(benchmark::State& state) {
    const SystemClock clock;
    const auto executor = std::make_shared<StepExecutor>();
    SkillDescription description{
        .parameters = {{.name = "TargetPosition", .type = ValueType::frame}},
        .results = {{.name = "Duration", .type = ValueType::number, .unit = kSecond}}};
    SkillFunctions functions{.start = [](const ValueMap&, const ExecutionHandle& execution) {
        execution.finish({{"Duration", 1.0}});
    }};
    Program program({}, std::make_unique<LambdaSkill>(std::move(description), std::move(functions)),
                    executor, clock);
    const Caller caller{"a session id of usual length", "client", "user"};
    for (auto _ : state) {
        benchmark::DoNotOptimize(program.write(caller, "TargetPosition", Frame{.x = 0.4}));
        benchmark::DoNotOptimize(program.start(caller));
        executor->run();
    }
}
BENCHMARK(writeStartAndFinish);

}  // namespace
}  // namespace metier::skill

BENCHMARK_MAIN();
