// A server that records executions one after another, for tests that kill it or run several.
// Arguments: store, ApplicationUri, how many executions (0: until it is killed).
// After each one that is told to the recorder, a line with its id and the time [us since 1970].
//
// With "flood" for the count it tells 6,000 a second until it is killed, with "wave" for two
// seconds, and of some of them, which have ended, by such a line; "ready" comes first. One in a
// hundred lasts as long as the next five hundred.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <string>
#include <thread>

#include "recorded.hpp"

namespace {

using namespace metier::records;
using namespace std::chrono_literals;

/// Between two executions of a server that goes on for ever, as of a fast skill.
constexpr auto kPause = 5ms;

constexpr auto kTick = 1ms;
constexpr long kOfATick = 6;
constexpr long kTicksOfAWave = 2'000;
constexpr long kLong = 100;         // every so many is a long one
constexpr std::size_t kAtOnce = 5;  // long ones
constexpr long kShown = 20;

void show(const std::string& id, metier::UtcTime time) {
    fmt::print(
        "{} {}\n", id,
        std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count());
    std::fflush(stdout);
}

struct UnderWay {
    Recorder::Key key = 0;
    std::string id{};
};

void end(Recorder& recorder, const UnderWay& execution, bool shown) {
    const auto now = std::chrono::system_clock::now();
    recorder.end(execution.key, finished(now),
                 {.time = now, .from = "Running", .to = "Ready", .reason = "Finished"});
    if (shown) {
        show(execution.id, now);
    }
}

int flood(const std::string& url, const std::string& server, long ticks) {
    const auto recorder = recorderOf(url, server, 100'000);
    if (!recorder->flush(soon())) {
        return EXIT_FAILURE;
    }
    fmt::print("ready\n");
    std::fflush(stdout);
    std::deque<UnderWay> long_ones;
    auto next = std::chrono::steady_clock::now();
    for (long i = 1; ticks == 0 || i <= ticks * kOfATick; ++i) {
        const auto now = std::chrono::system_clock::now();
        UnderWay begun{.id = fmt::format("{}-{}", server, i)};
        begun.key =
            recorder->begin(moveOf(begun.id, now), {.time = now, .from = "Ready", .to = "Running"});
        if (i % kLong == 0) {
            long_ones.push_back(std::move(begun));
        } else {
            end(*recorder, begun, i % kShown == 1);
        }
        if (long_ones.size() > kAtOnce) {
            end(*recorder, long_ones.front(), true);
            long_ones.pop_front();
        }
        if (i % kOfATick == 0) {
            next += kTick;
            std::this_thread::sleep_until(next);
        }
    }
    for (const auto& one : long_ones) {
        end(*recorder, one, true);
    }
    pause();
    return EXIT_FAILURE;
}

int record(const std::string& url, const std::string& server, long count) {
    const auto recorder = recorderOf(url, server);
    if (!recorder->flush(soon())) {  // the store is made
        return EXIT_FAILURE;
    }
    auto next = std::chrono::steady_clock::now();
    for (long i = 1; count == 0 || i <= count; ++i) {
        const auto now = std::chrono::system_clock::now();
        const auto id = fmt::format("{}-{}", server, i);
        const auto key = recorder->begin(moveOf(id, now));
        recorder->sample(key, sampleAt(0.001, static_cast<double>(i)));
        if (i != count) {
            recorder->end(key, finished(now + 1ms));  // the last one stays under way
        }
        show(id, now);
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
    if (argc != 4) {
        return EXIT_FAILURE;
    }
    const std::string how(argv[3]);
    if (how == "flood" || how == "wave") {
        return flood(argv[1], argv[2], how == "wave" ? kTicksOfAWave : 0);
    }
    return record(argv[1], argv[2], std::strtol(argv[3], nullptr, 10));
}
