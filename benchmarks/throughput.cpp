#include "throughput.hpp"

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

namespace metier::benchmarks {
namespace {

using std::chrono::steady_clock;

constexpr std::size_t kManyClients = 8;

}  // namespace

Throughput throughput(const Side& side, Watching watching, std::chrono::milliseconds time) {
    const ServerProcess server([&] { return side.serve(0); });
    std::atomic<std::size_t> count{0};
    std::vector<std::unique_ptr<Caller>> callers;
    for (std::size_t i = 0; i < kManyClients; ++i) {
        callers.push_back(side.connect(server.url()));
        if (watching == Watching::seen) {
            callers.back()->subscribe();
        }
    }
    const auto cpu_before = server.cpuTime();
    const auto thread_before = server.busiestThreadTime();
    const auto begin = steady_clock::now();
    {
        std::vector<std::jthread> threads;
        for (const auto& caller : callers) {
            threads.emplace_back([&count, &caller, end = begin + time] {
                while (steady_clock::now() < end) {
                    caller->start();
                    ++count;
                }
            });
        }
    }
    const std::chrono::duration<double> passed = steady_clock::now() - begin;
    const std::chrono::duration<double> used = server.cpuTime() - cpu_before;
    const std::chrono::duration<double, std::micro> thread =
        server.busiestThreadTime() - thread_before;
    const auto executions = static_cast<double>(count);
    return {executions / passed.count(), used.count() / passed.count(), thread.count() / executions,
            1e6 * used.count() / executions};
}

}  // namespace metier::benchmarks
