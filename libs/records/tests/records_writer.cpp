// A server that records executions one after another, for tests that kill it or run several.
// Arguments: store, ApplicationUri, how many executions (0: until it is killed).
// After each one that was given to the recorder, a line with its id and the time [us since 1970];
// "ready" comes first, and "health TEXT" whenever that changes.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "recorded.hpp"

namespace {

using namespace metier::records;
using namespace std::chrono_literals;

/// Pause between two executions of a server that runs for ever, as of a fast skill.
constexpr auto kPause = 5ms;

void show(const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
}

std::unique_ptr<Recorder> make(const std::string& url, const std::string& server) {
    Recorder::Options options;
    options.url = url;
    options.server = server;
    options.on_write_state = [](const WriteReport& report) { show("health " + report.text); };
    return Recorder::create(std::move(options)).value();
}

std::string timeOf(metier::UtcTime time) {
    using std::chrono::microseconds;
    return std::to_string(
        std::chrono::duration_cast<microseconds>(time.time_since_epoch()).count());
}

int record(const std::string& url, const std::string& server, long count) {
    const auto recorder = make(url, server);
    if (!recorder->flush(soon())) {  // the store is made
        return EXIT_FAILURE;
    }
    show("ready");
    auto next = std::chrono::steady_clock::now();
    for (long i = 1; count == 0 || i <= count; ++i) {
        const auto now = std::chrono::system_clock::now();
        const auto id = fmt::format("{}-{}", server, i);
        const auto key = recorder->begin(moveOf(id, now));
        recorder->sample(key, sampleAt(0.001, static_cast<double>(i)));
        if (i != count) {
            recorder->end(key, finished(now + 1ms));  // the last one stays under way
        }
        show(fmt::format("{} {}", id, timeOf(now)));
        if (count == 0) {
            next += kPause;
            std::this_thread::sleep_until(next);
        } else if (i % 500 == 0 && !recorder->flush(soon())) {
            return EXIT_FAILURE;
        }
    }
    return recorder->flush(soon()) ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
    return argc == 4 ? record(argv[1], argv[2], std::strtol(argv[3], nullptr, 10)) : EXIT_FAILURE;
}
