#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "../bench_server.hpp"
#include "metier/base/clock.hpp"

namespace metier::system_tests {

/// Durations of many repetitions of one action.
struct Durations {
    std::size_t count = 0;
    double median_ms = 0;
    double p99_ms = 0;
    double max_ms = 0;
};
Durations summaryOf(std::vector<double> milliseconds);

/// Durations of Halt, and its last failure.
struct HaltTimes {
    Durations answered;   ///< from the call to its answer
    Durations commanded;  ///< from the call to the skill's halt(), on the server's thread
    std::string defect;   ///< empty: each Halt halted
};

/// An operator on this machine, who starts a skill and halts it again and again.
///
/// Threading: one thread; the skill's halt() runs on the server's thread.
class HaltMeter {
public:
    /// Adds its skill to the server, which does not serve yet.
    explicit HaltMeter(BenchServer& server);
    /// Once the server serves. Throws if it does not let him in.
    void connect(const opcua::ClientOptions& options = {});
    /// Halts again and again for so long.
    HaltTimes measure(std::chrono::milliseconds time);

private:
    std::string call(const char* method);

    BenchServer& server_;
    std::atomic<SteadyTime> told_{SteadyTime{}};
    std::unique_ptr<opcua::Client> operator_;
};

}  // namespace metier::system_tests
