// How long arms take to stand after Halt and Suspend, by the clock of a client in another process.
//
// metier_stops_soak [STOPS] [ARM...]: moves of random length and pace of arms on their makers'
// wires (ur5, iiwa, edo), and of the UR5 over a move component (component), stopped at random
// points. The server's StoppingTime, read just before, is what a Halt of the set-points needs; what
// comes on top is the way of the request and of the event, the controller's lag, and for a
// component the play-out of the stream. Prints median, 99th percentile and largest of both.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "metier/client/kinematics_reader.hpp"
#include "metier_program.hpp"
#include "running_cell.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using skill::State;
using Seconds = std::chrono::duration<double>;

std::filesystem::path cellOf(const std::string& arm) {
    return std::filesystem::path(METIER_SOURCE_DIR) / "tests/system/devices" / (arm + ".toml");
}

void print(const std::string& name, std::vector<double> seconds) {
    std::sort(seconds.begin(), seconds.end());
    const auto at = [&](double share) {
        return 1e3 *
               seconds[static_cast<std::size_t>(share * static_cast<double>(seconds.size() - 1))];
    };
    fmt::print("{:<28} p50 {:7.1f} ms   p99 {:7.1f} ms   max {:7.1f} ms   ({} stops)\n", name,
               at(0.5), at(0.99), at(1.0), seconds.size());
}

class Stops {
public:
    explicit Stops(const std::string& url)
        : move_(url, "JointPtpMoveSkill"), home_(jointPosition(move_.client(), *move_)) {
        auto& client = move_.client();
        const auto kinematics = client::findKinematics(client, move_->address()).value();
        const auto metier = client.namespaceIndex("urn:metier:skills").value();
        stopping_time_ = client.translate(kinematics.object, {{metier, "StoppingTime"}}).value();
    }

    void run(const std::string& name, int stops) {
        for (int stop = 0; stop < stops; ++stop) {
            one(stop, stop % 2 == 0);
        }
        print(name + " Halt", halts_.took);
        print(name + " Halt, beyond told", halts_.beyond);
        print(name + " Suspend", suspends_.took);
        print(name + " Suspend, beyond told", suspends_.beyond);
    }

private:
    struct Figures {
        std::vector<double> took;
        std::vector<double> beyond;  ///< what the server had told
    };

    double part() { return std::uniform_real_distribution<double>()(random_); }

    /// Axis 1 by 0.3 to 1 rad, back towards where it began once it is more than that away.
    skill::ValueMap parameters(const std::vector<double>& from) {
        auto target = from;
        const double way = 0.3 + 0.7 * part();
        target.front() += target.front() > home_.front() ? -way : way;
        skill::ValueMap values{{"TargetJointPosition", target}};
        switch (std::uniform_int_distribution<int>(0, 3)(random_)) {
            case 0:
                values["Duration"] = 3.0 + 57.0 * part();
                break;
            case 1:
                values["SpeedOverride"] = 0.05 + 0.95 * part();
                break;
            case 2:
                values["MaxAcceleration"] = std::vector<double>(home_.size(), 0.1 + part());
                break;
            default:
                break;
        }
        return values;
    }

    void one(int stop, bool halts) {
        const auto id = fmt::format("stop-{}", stop);
        const auto from = jointPosition(move_.client(), *move_);
        if (const auto started =
                move_->startWith({.execution_id = id, .parameters = parameters(from)});
            !started) {
            throw std::runtime_error(started.error().message);
        }
        awaitMotion(move_.client(), *move_, from);
        const auto stop_at = std::chrono::steady_clock::now() + Seconds(0.3 * part());
        if (move_->awaitRest(std::chrono::time_point_cast<SteadyTime::duration>(stop_at))) {
            return;  // it had arrived
        }
        const auto told = move_.client().read(stopping_time_).value().as<double>().value();
        const auto asked = std::chrono::steady_clock::now();
        const auto taken = halts ? move_->halt() : move_->suspend();
        if (!taken) {
            return;  // it had arrived
        }
        const auto stands = move_->awaitRest(inAMinute());
        const double took = Seconds(std::chrono::steady_clock::now() - asked).count();
        if (!stands) {
            throw std::runtime_error(stands.error().message);
        }
        if (*stands == State::ready) {
            return;  // it had arrived
        }
        auto& figures = halts ? halts_ : suspends_;
        figures.took.push_back(took);
        figures.beyond.push_back(took - told);
        if (!halts) {
            static_cast<void>(move_->halt());
            static_cast<void>(move_->awaitState(State::halted, inAMinute()));
        }
        if (const auto reset = move_->reset(); !reset) {
            throw std::runtime_error(reset.error().message);
        }
    }

    Watched move_;
    std::vector<double> home_;
    opcua::NodeId stopping_time_;
    Figures halts_;
    Figures suspends_;
    std::mt19937 random_{1};
};

void soak(const std::string& arm, int stops) {
    const bool component = arm == "component";
    const RunningCell cell(cellOf(component ? "ur5" : arm));
    if (!component) {
        Stops(cell.url("arm")).run(arm, stops);
        return;
    }
    const ServerProcess moves("ur5-move", {"--port", "0", "--robot", cell.url("arm")});
    Stops(moves.url()).run(arm, stops);
}

}  // namespace
}  // namespace metier::system_tests

int main(int argc, char** argv) {
    std::vector<std::string> arguments(argv + 1, argv + argc);
    try {
        const int stops = arguments.empty() ? 1'000 : std::stoi(arguments[0]);
        std::vector<std::string> arms{"ur5", "iiwa", "edo", "component"};
        if (arguments.size() > 1) {
            arms.assign(arguments.begin() + 1, arguments.end());
        }
        for (const auto& arm : arms) {
            metier::system_tests::soak(arm, stops);
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}
