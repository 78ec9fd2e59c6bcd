// Time differences of two arms at start, on the way and at arrival, and the time that one runs on
// when the other is halted.
//
// metier_synchronized_soak [MOVES] [HALTS]: three processes on this machine, arms with cycles of
// 1 and 8 ms; prints median, 99th percentile and largest of each figure.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "metier_program.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using skill::Frame;
using skill::State;
using skill::ValueMap;

struct Cell {
    static ServerProcess serve(const std::string& name, std::vector<std::string> more = {}) {
        more.insert(more.end(), {"--port", "0"});
        return ServerProcess(
            name, more,
            std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "synchronized.toml");
    }

    ServerProcess left = serve("left");
    ServerProcess right = serve("right");
    ServerProcess both =
        serve("both", {"--use", "left=" + left.url(), "--use", "right=" + right.url()});
};

ValueMap target(int move, double duration) {
    const double along = move % 2 == 0 ? 0.0 : 0.1;
    return {{"TargetPoses", std::vector<Frame>{{0.5, along, 0.4, 3.14159, 0, 3.14159},
                                               {0.4, -0.3 + along, 0.5, 3.14, 0, 1}}},
            {"Duration", duration}};
}

void print(const std::string& name, std::vector<double> seconds) {
    if (seconds.empty()) {
        return;
    }
    std::sort(seconds.begin(), seconds.end());
    const auto at = [&](double share) {
        const auto last = static_cast<double>(seconds.size() - 1);
        return 1e3 * seconds[static_cast<std::size_t>(share * last)];
    };
    fmt::print("{:<18} p50 {:8.3f} ms   p99 {:8.3f} ms   max {:8.3f} ms   ({} values)\n", name,
               at(0.5), at(0.99), at(1.0), seconds.size());
}

void soakMoves(Cell& cell, int moves) {
    Watched both(cell.both.url(), "SynchronizedMoveSkill");
    std::map<std::string, std::vector<double>> figures;
    for (int move = 0; move < moves; ++move) {
        const auto result =
            both->runWith({fmt::format("move-{}", move), target(move, 0.0)}, inAMinute());
        if (!result) {
            throw std::runtime_error(result.error().message);
        }
        for (const auto* name : {"SkewAtStart", "LargestSkew", "SkewAtEnd", "ClockUncertainty"}) {
            figures[name].push_back(std::get<double>(result->at(name)));
        }
    }
    for (const auto& [name, values] : figures) {
        print(name, values);
    }
}

struct Watches {
    explicit Watches(Cell& cell)
        : left(cell.left.url(), "JointPtpMoveSkill"),
          right(cell.right.url(), "JointPtpMoveSkill"),
          both(cell.both.url(), "SynchronizedMoveSkill") {}

    Watched left;
    Watched right;
    Watched both;
};

/// Time from the Halted of one arm to that of the other, which has to brake before [s].
double haltOne(Watches& arms, int round) {
    const auto from = jointPosition(arms.left.client(), *arms.left);
    const auto started = arms.both->startWith({fmt::format("halt-{}", round), target(round, 20.0)});
    if (!started) {
        throw std::runtime_error(started.error().message);
    }
    arms.left.awaitEvent(State::running);
    arms.right.awaitEvent(State::running);
    awaitMotion(arms.left.client(), *arms.left, from);
    if (const auto asked = arms.left->halt(); !asked) {
        throw std::runtime_error(asked.error().message);
    }
    const auto halted = arms.left.awaitEvent(State::halted).time;
    const auto followed = arms.right.awaitEvent(State::halted).time;
    arms.both.awaitEvent(State::halted);
    static_cast<void>(arms.both->reset());
    static_cast<void>(arms.left->reset());
    arms.left.awaitEvent(State::ready);
    arms.right.awaitEvent(State::ready);
    return std::chrono::duration<double>(followed - halted).count();
}

void soakHalts(Cell& cell, int halts) {
    Watches arms(cell);
    std::vector<double> figures;
    for (int i = 0; i < halts; ++i) {
        try {
            figures.push_back(haltOne(arms, i));
        } catch (const std::runtime_error& error) {
            throw std::runtime_error(fmt::format("halt {}: {}; left {}, right {}, both {}", i,
                                                 error.what(), toString(arms.left->state().value()),
                                                 toString(arms.right->state().value()),
                                                 arms.both.awaitEvent(State::halted).reason_text));
        }
    }
    print("Halted to Halted", figures);
}

}  // namespace
}  // namespace metier::system_tests

int main(int argc, char** argv) {
    using namespace metier::system_tests;
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    try {
        Cell cell;
        soakMoves(cell, arguments.empty() ? 200 : std::stoi(arguments[0]));
        soakHalts(cell, arguments.size() < 2 ? 20 : std::stoi(arguments[1]));
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}
