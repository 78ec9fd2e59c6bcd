// Plans random motions and samples each: `metier_plans COUNT SEED [FIRST]`. A fault names its
// motion's number; `metier_plans 1 SEED NUMBER` repeats that motion alone.

#include <fmt/format.h>

#include <cstdlib>

#include "plan_fuzz.hpp"
#include "test_robots.hpp"

int main(int argc, char** argv) {
    const long count = argc > 1 ? std::atol(argv[1]) : 1'000'000;
    const auto number = [&](int i, std::uint64_t otherwise) {
        return argc > i ? std::strtoull(argv[i], nullptr, 10) : otherwise;
    };
    const std::uint64_t seed = number(2, 1);
    const std::uint64_t first = number(3, 0);
    std::vector<metier::motion::RobotModel> models;
    for (const std::string& name : metier::motion::kRobots) {
        models.push_back(metier::motion::loadRobot(name));
    }
    metier::motion::PlanFuzz fuzz(models, seed, first);
    long faults = 0;
    for (long i = 0; i < count; ++i) {
        if (const std::string fault = fuzz.next(); !fault.empty()) {
            ++faults;
            fmt::print("plan {}: {}\n", first + static_cast<std::uint64_t>(i), fault);
            std::fflush(stdout);
        }
    }
    fmt::print("{} motions, {} planned, {} faults\n", count, fuzz.planned(), faults);
    for (const auto& [what, share] : fuzz.shares()) {
        fmt::print("  {:26} at most {:.4f} of its limit\n", what, share);
    }
    return faults == 0 ? 0 : 1;
}
