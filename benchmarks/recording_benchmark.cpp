// What a record of each execution costs: executions/s of the spine's benchmark with and without.
//
// A round is two servers in processes of their own, one after the other: one records into a SQLite
// file, the other does not; which one comes first alternates. Eight clients start executions of one
// Program, which end at once, for two seconds. The cost is the median of the rounds' ratios, since
// the machine's speed changes from round to round. How many of the executions are in the file is
// counted after the recording server has ended.
//
// `recording_benchmark [ROUNDS]`: 15 unless told.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "metier/records/store.hpp"
#include "throughput.hpp"

namespace metier::benchmarks {
namespace {

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void removeStore(const std::string& file) {
    for (const auto* more : {"", "-wal", "-shm"}) {
        std::filesystem::remove(file + more);
    }
}

std::int64_t countOf(const std::string& file) {
    const auto store = records::Store::open(file);
    if (!store) {
        throw std::runtime_error(store.error().message);
    }
    const auto listed = (*store)->list({}, {.count = 1});
    return listed && !listed->executions.empty() ? listed->executions.front().number : 0;
}

struct Round {
    Throughput with;
    Throughput without;
    double recorded = 0;  ///< of the executions that began
};

constexpr std::chrono::milliseconds kTime{2000};

Round measure(Watching watching, bool recording_first, const std::string& file) {
    removeStore(file);
    Round round;
    if (!recording_first) {
        round.without = throughput(metierSide(), watching, kTime);
    }
    round.with = throughput(recordingSide(file), watching, kTime);
    if (recording_first) {
        round.without = throughput(metierSide(), watching, kTime);
    }
    const std::chrono::duration<double> seconds = kTime;
    round.recorded = static_cast<double>(countOf(file)) / (round.with.per_second * seconds.count());
    removeStore(file);
    return round;
}

/// Of all rounds, each beside the other.
class Comparison {
public:
    void add(const Round& round) {
        ratio_.push_back(round.with.per_second / round.without.per_second);
        recorded_.push_back(round.recorded);
        with_.push_back(round.with);
        without_.push_back(round.without);
    }
    void print(const char* name) const {
        const auto of = [](const std::vector<Throughput>& side, double Throughput::*what) {
            std::vector<double> values;
            for (const auto& one : side) {
                values.push_back(one.*what);
            }
            return median(values);
        };
        fmt::print("{:<30}", name);
        for (const auto what :
             {&Throughput::per_second, &Throughput::server_thread, &Throughput::server_threads}) {
            fmt::print(" {:>8.{}f} {:>8.{}f}", of(with_, what),
                       what == &Throughput::per_second ? 0 : 2, of(without_, what),
                       what == &Throughput::per_second ? 0 : 2);
        }
        fmt::print(" {:>8.4f} {:>8.3f}\n", median(ratio_), median(recorded_));
        static_cast<void>(std::fflush(stdout));
    }

private:
    std::vector<Throughput> with_;
    std::vector<Throughput> without_;
    std::vector<double> ratio_;
    std::vector<double> recorded_;
};

void compare(const char* name, Watching watching, std::size_t rounds, const std::string& file) {
    Comparison comparison;
    measure(watching, true, file);  // warms up
    for (std::size_t i = 0; i < rounds; ++i) {
        comparison.add(measure(watching, i % 2 == 0, file));
    }
    comparison.print(name);
}

}  // namespace
}  // namespace metier::benchmarks

int main(int argc, char** argv) {
    using namespace metier::benchmarks;
    try {
        const std::size_t rounds = argc > 1 ? std::stoul(argv[1]) : 15;
        const auto file =
            (std::filesystem::temp_directory_path() / fmt::format("recording_benchmark.db"))
                .string();
        fmt::print("{:<30} {:^17} {:^17} {:^17}   goal: ratio > 0.98\n", "", "executions/s",
                   "server thread [us]", "all threads [us]");
        fmt::print("{:<30} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "", "recorded",
                   "not", "recorded", "not", "recorded", "not", "ratio", "in file");
        compare("8 clients, nobody subscribed", Watching::unseen, rounds, file);
        compare("8 clients, each told of all", Watching::seen, rounds, file);
    } catch (const std::exception& error) {
        fmt::print(stderr, "recording_benchmark: {}\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
