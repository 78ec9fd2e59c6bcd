// The owner's death, in bulk. As root, for the faults of the network:
//   metier_owner_soak trials LEASE_MS [STRIDE] [sim|ur]   every fault, state and policy, and every
//                                      STRIDEth of 20 points of a move; prints a table
//   metier_owner_soak quiet MINUTES PERCENT [CLIENTS]     how often control is lost without cause
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>

#include "metier/client/control_handle.hpp"
#include "owner_death/trial.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;

std::vector<Trial> trialsOf(std::chrono::milliseconds lease, int stride) {
    std::vector<Trial> trials;
    for (const auto fault : kFaults) {
        for (const auto state : kStates) {
            const bool in_a_move = state == AtFault::running;
            for (const auto policy : kPolicies) {
                const int first = in_a_move ? 0 : kPoints / 2;
                const int last = in_a_move ? kPoints : first + 1;
                for (int point = first; point < last; point += stride) {
                    trials.push_back({fault, state, policy, lease, point});
                }
            }
        }
    }
    return trials;
}

double quantile(const std::vector<double>& sorted, double part) {
    return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
}

/// Median, 99 % and largest.
std::string quantilesOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? fmt::format("{:>22}", "-")
                          : fmt::format("{:>7.1f}{:>8.1f}{:>7.1f}", quantile(values, 0.5),
                                        quantile(values, 0.99), values.back());
}

struct Row {
    std::vector<double> after_lease;
    std::vector<double> after_fault;
    std::vector<double> standstill;
    int refused = 0;
    int defects = 0;

    void add(const Outcome& outcome) {
        after_lease.push_back(outcome.after_lease_ms);
        after_fault.push_back(outcome.after_fault_ms);
        if (outcome.standstill_ms) {
            standstill.push_back(*outcome.standstill_ms);
        }
        refused += outcome.refused;
        defects += outcome.defect.empty() ? 0 : 1;
    }
    void print(std::string_view name) const {
        fmt::print("{:<23}{:>5}{:>6} |{} |{} |{:>8}\n", name, after_lease.size(), defects,
                   quantilesOf(after_lease), quantilesOf(after_fault), refused);
    }
};

std::string load() {
    std::ifstream file("/proc/loadavg");
    std::string first;
    file >> first;
    return first;
}

std::string cellFile(const char* name) {
    return std::string(METIER_SOURCE_DIR) + name;
}

/// The simulated iiwa plans by itself; the UR5 is driven over its wire by a server and a move
/// component, which is the one that has an owner.
class Arm {
public:
    Arm(const std::string& kind, Cable& cable) {
        std::vector<std::string> serve{"serve", simulatedCell().string(), "--server", "iiwa"};
        if (kind == "ur") {
            const auto cell = cellFile("/cells/demo.toml");
            start({"virtual", "run", cell, "ur5-controller"});
            start({"serve", cell, "--server", "ur5"});
            serve = {"serve", cell, "--server", "ur5-move"};
        }
        row_.emplace(serve, "JointPtpMoveSkill", &cable, Bounds::strict);
    }
    DeathRow& row() { return *row_; }

private:
    void start(const std::vector<std::string>& arguments) {
        auto child = link::ChildProcess::start(metierCommand(arguments));
        if (!child || !child->readLine(inAMinute())) {
            throw std::runtime_error("metier " + arguments.front() + " does not start");
        }
        below_.push_back(std::move(*child));
    }

    std::vector<link::ChildProcess> below_;
    std::optional<DeathRow> row_;  // ends before what it stands on
};

int runTrials(std::chrono::milliseconds lease, int stride, const std::string& kind) {
    Cable cable;
    Arm arm(kind, cable);
    std::map<Fault, Row> rows;
    Row all;
    for (const auto& trial : trialsOf(lease, stride)) {
        const auto outcome = arm.row().run(trial);
        rows[trial.fault].add(outcome);
        all.add(outcome);
        if (!outcome.defect.empty()) {
            fmt::print("{}: {}\n", toString(trial), outcome.defect);
        }
    }
    fmt::print("{}, lease {} ms, load {}; milliseconds: median, 99 %, largest\n", kind,
               lease.count(), load());
    fmt::print("{:<23}{:>5}{:>6} |{:^22} |{:^22} |{:>8}\n", "fault", "n", "wrong",
               "stop after the lease", "stop after the fault", "refused");
    for (const auto& [fault, row] : rows) {
        row.print(toString(fault));
    }
    all.print("all");
    fmt::print("from the stop to OwnerLost: {} ms; {} of {} as they have to be\n",
               quantilesOf(all.standstill), all.after_lease.size() - all.defects,
               all.after_lease.size());
    return all.defects == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/// Clients that hold control over a bad network; no fault, so every loss is a false one.
int stayQuiet(std::chrono::minutes time, int percent, std::size_t clients) {
    Cable cable;
    std::vector<std::unique_ptr<OwnedServer>> servers;
    std::vector<link::ChildProcess> owners;
    for (std::size_t i = 0; i < clients; ++i) {
        servers.push_back(std::make_unique<OwnedServer>(std::vector<std::string>{
            "serve", simulatedCell().string(), "--server", "ur5", "--port", "0"}));
        auto owner = link::ChildProcess::start(cable.atFarEnd(
            metierCommand({"own", Cable::addressOf(servers.back()->url()), "--lease", "1s"})));
        if (!owner || !owner->readLine(inAMinute())) {
            throw std::runtime_error("metier own does not start");
        }
        owners.push_back(std::move(*owner));
    }
    cable.lose(percent);
    const auto end = std::chrono::steady_clock::now() + time;
    int losses = 0;
    for (auto& server : servers) {
        for (; server->awaitLoss(end); ++losses) {
        }
    }
    fmt::print(
        "{} clients, {} min, {} % of the packets lost in each direction, load {}: {} false "
        "stops\nlost, towards server and client: {}",
        clients, time.count(), percent, load(), losses, cable.lossCounts());
    return losses == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

int soak(const std::vector<std::string>& arguments) {
    if (const auto obstacle = Cable::obstacle(); !obstacle.empty()) {
        fmt::print(stderr, "owner soak: {}\n", obstacle);
        return EXIT_FAILURE;
    }
    const auto number = [&](std::size_t i, int otherwise) {
        return arguments.size() > i ? std::stoi(arguments[i]) : otherwise;
    };
    if (!arguments.empty() && arguments[0] == "quiet") {
        return stayQuiet(std::chrono::minutes(number(1, 30)), number(2, 5),
                         static_cast<std::size_t>(number(3, 1)));
    }
    return runTrials(std::chrono::milliseconds(number(1, 300)), number(2, 1),
                     arguments.size() > 3 ? arguments[3] : "sim");
}

}  // namespace
}  // namespace metier::system_tests

int main(int argc, char** argv) {
    try {
        return metier::system_tests::soak({argv + 1, argv + argc});
    } catch (const std::exception& error) {
        fmt::print(stderr, "owner soak: {}\n", error.what());
        return EXIT_FAILURE;
    }
}
