// Time until arms stand after Halt and Suspend, asked for by another process.
//
// metier_stops_soak [STOPS] [ARM...]: moves of random length and pace of arms on their makers'
// wires (ur5, iiwa, edo), and of the same arms over a move component (ur5_component, ...), stopped
// at random points. A Halt may take 1.2 times the StoppingTime that the server had published just
// before, a Suspend 0.5 s or 1.2 times what the robot's own limits need; besides two cycles, a
// round trip of a call, and over a component the play-out delay of its stream. Prints when the arm
// stood: by the positions that its server measured, by the time of the transition, and by the clock
// of this client, which wakes up late on a busy machine; and the excess, the share of the allowed
// time by which it took longer. Ends with status 1 if more than 2 % of the Halts or of the Suspends
// of an arm are over it by the measured positions. Several of these processes may run side by side.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "metier/client/kinematics_reader.hpp"
#include "metier_program.hpp"
#include "running_cell.hpp"
#include "stops/position_track.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using skill::State;
using Seconds = std::chrono::duration<double>;

constexpr double kReserve = 1.2;     // factor on the time that the limits allow
constexpr double kGentleStop = 0.5;  // a Suspend may keep the limits of the plan so long [s]
constexpr double kMostOver = 0.02;   // share of the stops of one kind
constexpr double kPlayOut = 0.02;    // of a component's stream [s], at least so many cycles:
constexpr double kPlayOutCycles = 3;

/// Times from the request until the arm stands [s].
struct Stop {
    double told = 0;  ///< StoppingTime just before the request
    double allowed = 0;
    double by_position = 0;  ///< by the positions that the arm's server measured
    double by_event = 0;     ///< by the time of the transition
    double by_client = 0;    ///< by the clock of this client
};

using Stops = std::vector<Stop>;

void print(const std::string& name, const Stops& stops, double Stop::*figure) {
    std::vector<double> seconds;
    std::transform(stops.begin(), stops.end(), std::back_inserter(seconds),
                   [&](const Stop& stop) { return stop.*figure; });
    std::sort(seconds.begin(), seconds.end());
    const auto at = [&](double share) {
        const auto last = static_cast<double>(seconds.size() - 1);
        return 1e3 * seconds[static_cast<std::size_t>(share * last)];
    };
    fmt::print("{:<32} p50 {:7.1f} ms   p99 {:7.1f} ms   max {:7.1f} ms\n", name, at(0.5), at(0.99),
               at(1.0));
}

/// \return the share of the stops that took longer than allowed
double printExcess(const std::string& name, const Stops& stops, double Stop::*took) {
    const auto excess = [&](const Stop& stop) { return stop.*took / stop.allowed - 1.0; };
    const auto worst = *std::max_element(
        stops.begin(), stops.end(),
        [&](const Stop& left, const Stop& right) { return excess(left) < excess(right); });
    const auto over = std::count_if(stops.begin(), stops.end(),
                                    [&](const Stop& stop) { return excess(stop) > 0.0; });
    fmt::print(
        "{:<32} {} of {} over, largest excess {:+.1f} %: told {:.1f} ms, allowed {:.1f} ms, "
        "took {:.1f} ms\n",
        name, over, stops.size(), 1e2 * excess(worst), 1e3 * worst.told, 1e3 * worst.allowed,
        1e3 * (worst.*took));
    return static_cast<double>(over) / static_cast<double>(stops.size());
}

/// \return whether they keep to the bound
bool report(const std::string& name, const Stops& stops) {
    if (stops.empty()) {
        return true;
    }
    print(name + ", positions", stops, &Stop::by_position);
    print(name + ", transition", stops, &Stop::by_event);
    print(name + ", this client", stops, &Stop::by_client);
    const double share = printExcess(name + ", positions", stops, &Stop::by_position);
    printExcess(name + ", transition", stops, &Stop::by_event);
    return share <= kMostOver;
}

/// One arm, and how soon it stands.
class StoppedArm {
public:
    /// \param url     of the server whose moves are stopped
    /// \param arm_url of the server that has the arm itself
    StoppedArm(const std::string& url, const std::string& arm_url)
        : move_(url, "JointPtpMoveSkill"),
          track_(arm_url, "PositionStreamSkill"),
          home_(jointPosition(move_.client(), *move_)) {
        auto& client = move_.client();
        const auto nodes = client::findKinematics(client, move_->address()).value();
        kinematics_ = client::readKinematics(client, nodes).value();
        const auto metier = client.namespaceIndex("urn:metier:skills").value();
        stopping_time_ = client.translate(nodes.object, {{metier, "StoppingTime"}}).value();
        const double cycle = kinematics_.cycle_time;
        delay_ = url == arm_url ? 0.0 : std::max(kPlayOut, kPlayOutCycles * cycle);
    }

    void run(int stops) {
        for (int i = 0; i < stops; ++i) {
            const auto how = i % 2 == 0 ? State::halted : State::suspended;
            const auto id = fmt::format("stop-{}", i);
            if (!beginMove(id)) {
                continue;
            }
            if (const auto stop = stopAndWait(id, how)) {
                (how == State::halted ? halts_ : suspends_).push_back(*stop);
                makeReady(how);
            }
        }
    }
    const Stops& halts() const { return halts_; }
    const Stops& suspends() const { return suspends_; }

private:
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

    /// Lets it move for up to 0.3 s. \return false if it has arrived by then
    bool beginMove(const std::string& id) {
        const auto from = jointPosition(move_.client(), *move_);
        const auto started = move_->startWith({.execution_id = id, .parameters = parameters(from)});
        if (!started) {
            throw std::runtime_error(started.error().message);
        }
        awaitMotion(move_.client(), *move_, from);
        const auto stop_at = std::chrono::steady_clock::now() + Seconds(0.3 * part());
        return !move_->awaitRest(std::chrono::time_point_cast<SteadyTime::duration>(stop_at));
    }

    /// Time of a stop with the robot's own limits, if one with twice the limits takes `halt` [s].
    double withOwnLimits(double halt) const {
        const double a = kinematics_.max_joint_acceleration.front();
        const double j = kinematics_.max_joint_jerk.front();
        if (halt >= 2 * a / j) {
            return 2 * halt - a / j;
        }
        const double v = halt * halt * j / 2;
        return v >= a * a / j ? v / a + a / j : 2 * std::sqrt(v / j);
    }

    double allowed(State how, double told) const {
        const double stop = how == State::halted
                                ? kReserve * told
                                : std::max(kGentleStop, kReserve * withOwnLimits(told));
        return stop + 2 * kinematics_.cycle_time + delay_;
    }

    /// \return nothing if it arrived before it stood
    std::optional<Stop> stopAndWait(const std::string& id, State how) {
        track_.restart();
        const auto before = std::chrono::steady_clock::now();
        const auto told = move_.client().read(stopping_time_).value().as<double>().value();
        const auto asked = std::chrono::steady_clock::now();
        const auto asked_utc = std::chrono::system_clock::now();
        const auto answer = how == State::halted ? move_->halt() : move_->suspend();
        const auto stands = answer ? move_->awaitRest(inAMinute()) : State::ready;
        const auto heard = std::chrono::steady_clock::now();
        if (!stands) {
            throw std::runtime_error(stands.error().message);
        }
        if (*stands == State::ready) {
            return std::nullopt;
        }
        const double round_trip = Seconds(asked - before).count();
        return Stop{
            .told = told,
            .allowed = allowed(how, told) + round_trip,
            .by_position = std::max(0.0, Seconds(track_.restSince() - asked_utc).count()),
            .by_event = Seconds(transitionOf(id, how) - asked_utc).count(),
            .by_client = Seconds(heard - asked).count(),
        };
    }

    UtcTime transitionOf(const std::string& id, State to) {
        for (;;) {
            const auto event = move_.awaitEvent(to);
            if (event.execution_id == id) {
                return event.time;
            }
        }
    }

    void makeReady(State from) {
        if (from == State::suspended) {
            static_cast<void>(move_->halt());
            static_cast<void>(move_->awaitState(State::halted, inAMinute()));
        }
        if (const auto reset = move_->reset(); !reset) {
            throw std::runtime_error(reset.error().message);
        }
    }

    Watched move_;
    PositionTrack track_;
    std::vector<double> home_;
    opcua_skill::KinematicsData kinematics_;
    opcua::NodeId stopping_time_;
    double delay_ = 0;  ///< of a component's stream [s]
    Stops halts_;
    Stops suspends_;
    std::mt19937 random_{1};
};

bool soak(const std::string& name, int stops) {
    const auto underscore = name.find('_');
    const auto device = name.substr(0, underscore);
    const RunningCell cell(std::filesystem::path(METIER_SOURCE_DIR) / "tests/system/devices" /
                           (device + ".toml"));
    const auto& arm_url = cell.url("arm");
    std::optional<ServerProcess> component;
    if (underscore != std::string::npos) {
        component.emplace("ur5-move", std::vector<std::string>{"--port", "0", "--robot", arm_url});
    }
    StoppedArm arm(component ? component->url() : arm_url, arm_url);
    arm.run(stops);
    const bool halts = report(name + " Halt", arm.halts());
    const bool suspends = report(name + " Suspend", arm.suspends());
    return halts && suspends;
}

}  // namespace
}  // namespace metier::system_tests

int main(int argc, char** argv) {
    std::vector<std::string> arguments(argv + 1, argv + argc);
    bool kept = true;
    try {
        const int stops = arguments.empty() ? 1'000 : std::stoi(arguments[0]);
        std::vector<std::string> arms{"ur5", "iiwa", "edo", "ur5_component"};
        if (arguments.size() > 1) {
            arms.assign(arguments.begin() + 1, arguments.end());
        }
        for (const auto& arm : arms) {
            kept = metier::system_tests::soak(arm, stops) && kept;
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return kept ? 0 : 1;
}
