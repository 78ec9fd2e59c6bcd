// Cost of a record of each execution: executions/s of the spine's benchmark with and without.
//
// Clients start executions of one Program again and again for eight seconds: one client with a
// skill that takes a millisecond; eight clients with one that ends at once, a load that no robot
// makes. Meanwhile the server's recording into a SQLite file is turned on and off in slices of 40
// ms, two by two, so that both kinds see the same process and the same state of the machine, whose
// changes are larger than the wanted difference; of each kind the middle half is used. That is one
// round; each has a server process of its own. The writer's thread works during both kinds of
// slices, so its time, which is shown for each recorded execution, is subtracted from the ratio as
// a share of all cores: eight clients leave none of them idle. The executions in the file are
// counted after the server has ended; those that exceed the queue are dropped.
//
// `recording_benchmark [ROUNDS]`: 10 by default.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

#include "both_sides.hpp"
#include "metier/records/store.hpp"
#include "recording_switch.hpp"
#include "throughput.hpp"

namespace metier::benchmarks {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr int kSlices = 180;
constexpr int kWarmUp = 8;  // slices that do not count
constexpr auto kSlice = 40ms;
/// After a turn, until the caches are as they stay.
constexpr auto kSettle = 3ms;

void removeStore(const std::string& file) {
    for (const auto* more : {"", "-wal", "-shm", "-servers"}) {
        std::filesystem::remove(file + more);
    }
}

double countOf(const std::string& file) {
    const auto store = records::Store::open(file);
    if (!store) {
        throw std::runtime_error(store.error().message);
    }
    const auto listed = (*store)->list({}, {.count = 1});
    return listed && !listed->executions.empty()
               ? static_cast<double>(listed->executions.front().number)
               : 0.0;
}

double microseconds(std::chrono::nanoseconds time) {
    return std::chrono::duration<double, std::micro>(time).count();
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Mean of the middle half.
double middle(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto quarter = static_cast<std::ptrdiff_t>(values.size() / 4);
    return mean({values.begin() + quarter, values.end() - quarter});
}

/// Clients and the skill that they start.
struct Case {
    const char* name;
    double goal;  // ratio
    std::size_t clients;
    std::chrono::microseconds work;
    Watching watching = Watching::unseen;
};

/// Clients that start executions for as long as this lives.
class Load {
public:
    Load(const Side& side, const std::string& url, const Case& one) {
        for (std::size_t i = 0; i < one.clients; ++i) {
            callers_.push_back(side.connect(url));
            if (one.watching == Watching::seen) {
                callers_.back()->subscribe();
            }
        }
        for (const auto& caller : callers_) {
            threads_.emplace_back([this, &caller](const std::stop_token& stop) {
                while (!stop.stop_requested()) {
                    caller->start();
                    ++count_;
                }
            });
        }
    }
    double count() const { return static_cast<double>(count_); }

private:
    std::atomic<std::size_t> count_{0};
    std::vector<std::unique_ptr<Caller>> callers_;
    std::vector<std::jthread> threads_;  // end before what they use
};

/// Results of all slices of a kind.
struct Slices {
    std::vector<double> per_second;
    std::vector<double> server_thread;  // us for each execution
};

struct Round {
    std::array<Slices, 2> slices;  // not recorded, recorded
    double writer = 0;             // us for each recorded execution
    double in_file = 0;            // of the executions that began while recording was on
};

Round measure(const Case& one, const std::string& file) {
    removeStore(file);
    const RecordingSwitch recording(file);
    const auto side = recordingSide(recording, one.work);
    Round round;
    double recorded = 0;
    {
        const ServerProcess server([&] { return side.serve(0); });
        const Load load(side, server.url(), one);
        for (int i = 0; i < kSlices; ++i) {
            const bool on = i % 4 == 1 || i % 4 == 2;
            const auto turned_on = load.count();
            recording.turn(on);
            std::this_thread::sleep_for(kSettle);
            const auto count = load.count();
            const auto thread_time = server.busiestThreadTime();
            const auto begin = steady_clock::now();
            std::this_thread::sleep_for(kSlice);
            const auto started = load.count() - count;
            const std::chrono::duration<double> passed = steady_clock::now() - begin;
            auto& slices = round.slices.at(on ? 1 : 0);
            if (i >= kWarmUp) {
                slices.per_second.push_back(started / passed.count());
                slices.server_thread.push_back(
                    microseconds(server.busiestThreadTime() - thread_time) / started);
            }
            recorded += on ? load.count() - turned_on : 0;
        }
        recording.turn(false);
        round.writer = microseconds(server.yieldingThreadsTime()) / recorded;
    }
    round.in_file = countOf(file) / recorded;
    removeStore(file);
    return round;
}

void compare(const Case& one, std::size_t rounds, const std::string& file) {
    std::vector<double> ratio;
    std::vector<double> writer;
    std::vector<double> in_file;
    std::array<std::vector<double>, 2> per_second;
    std::array<std::vector<double>, 2> server_thread;
    for (std::size_t i = 0; i < rounds; ++i) {
        const auto round = measure(one, file);
        for (std::size_t kind = 0; kind < 2; ++kind) {
            per_second.at(kind).push_back(middle(round.slices.at(kind).per_second));
            server_thread.at(kind).push_back(middle(round.slices.at(kind).server_thread));
        }
        const auto cores = static_cast<double>(std::thread::hardware_concurrency());
        const auto writers_share = 1e-6 * round.writer * per_second[1].back() / cores;
        ratio.push_back(per_second[1].back() / per_second[0].back() * (1.0 - writers_share));
        writer.push_back(round.writer);
        in_file.push_back(round.in_file);
    }
    double squares = 0;
    for (const auto each : ratio) {
        squares += (each - mean(ratio)) * (each - mean(ratio));
    }
    const auto count = static_cast<double>(rounds);
    fmt::print(
        "{:<30} {:>8.0f} {:>8.0f} {:>8.2f} {:>8.2f} {:>13.2f} {:>9.4f} {:>8.4f} {:>8.3f} "
        "{:>6.2f}\n",
        one.name, mean(per_second[1]), mean(per_second[0]), mean(server_thread[1]),
        mean(server_thread[0]), mean(writer), mean(ratio), std::sqrt(squares / (count - 1) / count),
        mean(in_file), one.goal);
    static_cast<void>(std::fflush(stdout));
}

}  // namespace
}  // namespace metier::benchmarks

int main(int argc, char** argv) {
    using namespace metier::benchmarks;
    try {
        const std::size_t rounds = argc > 1 ? std::stoul(argv[1]) : 10;
        const auto file =
            (std::filesystem::temp_directory_path() / fmt::format("recording_benchmark.db"))
                .string();
        fmt::print("{:<30} {:^17} {:^17} {:>13}\n", "", "executions/s", "server thread [us]",
                   "writer [us]");
        fmt::print("{:<30} {:>8} {:>8} {:>8} {:>8} {:>13} {:>9} {:>8} {:>8} {:>6}\n", "",
                   "recorded", "not", "recorded", "not", "for a record", "ratio", "+-", "in file",
                   "goal");
        for (const auto& one :
             {Case{"1 client, a skill of 1 ms", 0.98, 1, 1ms},
              Case{"8 clients, it ends at once", 0.80, 8, 0us},
              Case{"the same, all see all events", 0.80, 8, 0us, Watching::seen}}) {
            compare(one, rounds, file);
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "recording_benchmark: {}\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
