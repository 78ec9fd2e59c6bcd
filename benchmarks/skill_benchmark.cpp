// Cost of skills against OPC UA alone: metier and a bare open62541 server in the same run.
//
// Every server is a process of its own; the clients are threads of this one. For lines that measure
// times, the servers of both sides run side by side and are called in turn, so that a slowdown of
// the machine meets both. Both clients ask for events every 100 ms.
//
// - Start call: metier's Start, two transitions included, against a bare method without arguments
//   that does nothing; one client, no subscription. The same bare client for both servers, then
//   metier's own, which waits for its thread;
// - Start to Running: from before the call until the subscriber's callback has the event; the next
//   Start follows at once, so the stock server's timer has always just fired;
// - executions: eight clients call Start of one Program for two seconds; the bare method raises two
//   events with Time and Severity. Unseen: no subscription; seen: each client gets all events of
//   that Program;
// - many skills: from an empty process until clients may connect; resident memory is the increase
//   by that. Skills have six parameters each, bare Programs as well; metier's NodeSets are part of
//   its figures. Readable and compact: NodeStyle;
// - idle clients: CPU time of the server's process while ten subscribed clients do nothing.
//
// `opcua_skill_benchmark [SKILLS]`: number of skills for "many skills", 10000 by default.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>

#include "both_sides.hpp"
#include "throughput.hpp"

namespace metier::benchmarks {
namespace {

using std::chrono::steady_clock;

constexpr std::size_t kRounds = 10;
constexpr std::size_t kCallsPerRound = 500;
constexpr std::size_t kEventsPerRound = 10;
constexpr std::size_t kIdleClients = 10;
constexpr std::chrono::seconds kIdleTime{5};

struct Line {
    std::string name;
    std::string unit;
    double metier = 0;
    double bare = 0;
    std::string goal;
};

void print(const Line& line) {
    fmt::print("{:<32} {:>11.3f} {:>11.3f} {:>9.3f}  {:<9} {}\n", line.name, line.metier, line.bare,
               line.metier / line.bare, line.unit, line.goal);
    static_cast<void>(std::fflush(stdout));
}

/// Times of one thing, in microseconds.
class Samples {
public:
    void add(std::chrono::nanoseconds time) {
        values_.push_back(std::chrono::duration<double, std::micro>(time).count());
    }
    double quantile(double fraction) {
        std::sort(values_.begin(), values_.end());
        return values_.at(
            static_cast<std::size_t>(fraction * static_cast<double>(values_.size() - 1)));
    }

private:
    std::vector<double> values_;
};

struct Both {
    Samples metier;
    Samples bare;
};

/// Measures a side of metier and the bare one in turn, with one client each on a server with one
/// Program.
template <typename Prepare, typename Measure>
Both inTurn(const Side& metier_side, std::size_t per_round, Prepare prepare, Measure measure) {
    const auto bare_side = bareSide();
    const ServerProcess metier_server([&] { return metier_side.serve(0); });
    const ServerProcess bare_server([&] { return bare_side.serve(0); });
    const auto metier = metier_side.connect(metier_server.url());
    const auto bare = bare_side.connect(bare_server.url());
    prepare(*metier);
    prepare(*bare);
    Both both;
    for (std::size_t round = 0; round <= kRounds; ++round) {
        for (std::size_t i = 0; i < per_round; ++i) {
            const auto metier_time = measure(*metier);
            const auto bare_time = measure(*bare);
            if (round > 0) {  // the first one warms up
                both.metier.add(metier_time);
                both.bare.add(bare_time);
            }
        }
    }
    return both;
}

void callLatency(const std::string& name, const Side& metier, const std::string& goal) {
    auto both = inTurn(
        metier, kCallsPerRound, [](Caller&) {},
        [](Caller& caller) {
            const auto begin = steady_clock::now();
            caller.call();
            return steady_clock::now() - begin;
        });
    print({name + " p50", "us", both.metier.quantile(0.5), both.bare.quantile(0.5), goal});
    print({name + " p99", "us", both.metier.quantile(0.99), both.bare.quantile(0.99), ""});
}

void eventLatency() {
    auto both = inTurn(
        metierSide(), kEventsPerRound, [](Caller& caller) { caller.subscribe(); },
        [](Caller& caller) { return caller.startUntilRunning(); });
    print({"Start to Running event p50", "us", both.metier.quantile(0.5), both.bare.quantile(0.5),
           "< 500 us"});
    print({"Start to Running event p99", "us", both.metier.quantile(0.99), both.bare.quantile(0.99),
           "< 2000 us"});
}

void executions() {
    for (const auto watching : {Watching::unseen, Watching::seen}) {
        const bool seen = watching == Watching::seen;
        const auto metier = throughput(metierSide(), watching).per_second;
        const auto bare = throughput(bareSide(), watching).per_second;
        print({seen ? "executions, 8 clients, seen" : "executions, 8 clients, unseen", "1/s",
               metier, bare, "> 2000/s"});
    }
}

/// Costs of many Programs.
struct Cost {
    double seconds = 0;
    double megabytes = 0;
};

void manySkills(std::size_t count) {
    constexpr double kMegabyte = 1024.0 * 1024.0;
    using opcua_skill::NodeStyle;
    const auto cost = [count](const Side& side) {
        const ServerProcess server([&] { return side.serve(count); });
        return Cost{server.startTime().count(), server.memory() / kMegabyte};
    };
    const auto bare = cost(bareSide());
    for (const auto style : {NodeStyle::readable, NodeStyle::compact}) {
        const auto metier = cost(metierSide(style));
        const auto* nodes = style == NodeStyle::readable ? "readable" : "compact";
        print({fmt::format("{} {} skills, start", count, nodes), "s", metier.seconds, bare.seconds,
               "ratio <= 2"});
        print({fmt::format("{} {} skills, memory", count, nodes), "MB", metier.megabytes,
               bare.megabytes, "ratio <= 2"});
    }
}

/// CPU of a server while subscribed clients idle, in percent of a core.
double idleLoad(const Side& side) {
    const ServerProcess server([&] { return side.serve(0); });
    std::vector<std::unique_ptr<Caller>> callers;
    for (std::size_t i = 0; i < kIdleClients; ++i) {
        callers.push_back(side.connect(server.url()));
        callers.back()->subscribe();
    }
    const auto before = server.cpuTime();
    const auto begin = steady_clock::now();
    {
        std::vector<std::jthread> threads;
        for (const auto& caller : callers) {
            threads.emplace_back([&caller, end = begin + kIdleTime] { caller->idleUntil(end); });
        }
    }
    const std::chrono::duration<double> used = server.cpuTime() - before;
    const std::chrono::duration<double> passed = steady_clock::now() - begin;
    return 100.0 * used.count() / passed.count();
}

void idleClients() {
    const auto metier = idleLoad(metierSide());
    const auto bare = idleLoad(bareSide());
    print({"ten idle clients", "% of a core", metier, bare, "< 1 %"});
}

}  // namespace
}  // namespace metier::benchmarks

int main(int argc, char** argv) {
    using namespace metier::benchmarks;
    try {
        fmt::print("{:<32} {:>11} {:>11} {:>9}  {:<9} {}\n", "", "metier", "bare", "ratio", "unit",
                   "goal");
        callLatency("Start call, bare client", metierServerBareClient(), "ratio <= 2");
        callLatency("Start call, metier's client", metierSide(), "");
        eventLatency();
        executions();
        manySkills(argc > 1 ? std::stoul(argv[1]) : 10'000);
        idleClients();
    } catch (const std::exception& error) {
        fmt::print(stderr, "opcua_skill_benchmark: {}\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
