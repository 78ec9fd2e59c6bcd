#include "dashboard_reset.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "metier/link/back_off.hpp"

namespace metier::ur_driver {

using namespace std::chrono_literals;

namespace {

constexpr auto kDashboardTimeout = 1s;  // deadline of one command
constexpr auto kUnlockTimeout = 3s;
constexpr auto kStopTimeout = 2s;
constexpr auto kPowerTimeout = 60s;  // an arm takes 10 to 20 s
constexpr auto kPoll = 5ms;

SteadyTime commandDeadline() {
    return std::chrono::steady_clock::now() + kDashboardTimeout;
}

bool isSafe(const ControllerState& state) {
    return state.safety_mode == SafetyMode::normal || state.safety_mode == SafetyMode::reduced;
}

}  // namespace

DashboardReset::DashboardReset(Peer peer, const UrSettings& settings,
                               std::function<Observation()> newest, SafetyReporter& reporter)
    : peer_(std::move(peer)),
      settings_(settings),
      newest_(std::move(newest)),
      reporter_(reporter) {}

tl::unexpected<Error> DashboardReset::refuse(const std::string& why) const {
    return fail(Errc::device_fault, peer_.name + ": " + why);
}

Result<dashboard::Client> DashboardReset::dial() const {
    auto client =
        dashboard::Client::connect(peer_.host, settings_.dashboard_port, commandDeadline());
    if (!client) {
        return fail(client.error().code, peer_.name + ": " + client.error().message);
    }
    return client;
}

Result<void> DashboardReset::command(dashboard::Client& client, std::string_view text,
                                     std::string_view expected) const {
    const auto done = client.command(text, expected, commandDeadline());
    return done ? done : refuse(done.error().message);
}

Result<void> DashboardReset::run(const std::stop_token& stop) {
    const auto now = newest_();
    if (!now.connected) {
        return fail(Errc::connection_lost, peer_.name + ": no connection to the controller");
    }
    if (!now.standing) {
        return refuse("the arm still moves");
    }
    return leaveSafetyStop(stop)
        .and_then([&] { return powerOn(stop); })
        .and_then([&] { return endPausedProgram(stop); })
        .and_then([&] { return checkSlider(); })
        .and_then([&]() -> Result<void> {
            reporter_.unlatch();
            return {};
        });
}

Result<void> DashboardReset::leaveSafetyStop(const std::stop_token& stop) {
    const auto state = newest_().state;
    if (isSafe(state)) {
        return {};
    }
    if (state.safety_mode == SafetyMode::protective_stop) {
        return unlock(stop);
    }
    return refuse(judge(state.robot_mode, state.safety_mode).text);
}

Result<void> DashboardReset::unlock(const std::stop_token& stop) {
    const auto left = reporter_.since() + settings_.unlock_delay - std::chrono::steady_clock::now();
    if (left > 0ns) {
        return refuse(fmt::format("the protective stop can be unlocked in {:.1f} s",
                                  std::chrono::duration<double>(left).count()));
    }
    METIER_ASSIGN(auto client, dial());
    // Their replies show only whether there was a popup; a link that fails now also fails below.
    (void)client.ask("close safety popup", commandDeadline());
    (void)client.ask("close popup", commandDeadline());
    METIER_TRY(command(client, "unlock protective stop", "Protective stop releasing"));
    return await(isSafe, kUnlockTimeout, "the protective stop was not released", stop);
}

Result<void> DashboardReset::powerOn(const std::stop_token& stop) {
    const auto mode = newest_().state.robot_mode;
    if (mode == RobotMode::running) {
        return {};
    }
    const bool can =
        mode == RobotMode::power_off || mode == RobotMode::power_on || mode == RobotMode::idle;
    if (!can) {
        return refuse(judge(mode, SafetyMode::normal).text);
    }
    if (settings_.power_on != UrSettings::PowerOn::by_reset) {
        return refuse(fmt::format(
            "robot mode {}: power on and release the brakes at the pendant (the setting power_on "
            "lets Reset do it)",
            toText(mode)));
    }
    METIER_ASSIGN(auto client, dial());
    if (mode != RobotMode::idle) {
        METIER_TRY(command(client, "power on", "Powering on"));
        METIER_TRY(await(
            [](const ControllerState& state) {
                return state.robot_mode == RobotMode::idle ||
                       state.robot_mode == RobotMode::running;
            },
            kPowerTimeout, "the arm was not powered on", stop));
    }
    METIER_TRY(command(client, "brake release", "Brake releasing"));
    return await([](const ControllerState& s) { return s.robot_mode == RobotMode::running; },
                 kPowerTimeout, "the brakes were not released", stop);
}

Result<void> DashboardReset::endPausedProgram(const std::stop_token& stop) {
    if (newest_().state.runtime_state != RuntimeState::paused) {
        return {};
    }
    METIER_TRY(stopProgram());
    return await(
        [](const ControllerState& state) { return state.runtime_state == RuntimeState::stopped; },
        kStopTimeout, "the paused program was not stopped", stop);
}

Result<void> DashboardReset::stopProgram() {
    METIER_ASSIGN(auto client, dial());
    return command(client, "stop", "Stopped");
}

Result<void> DashboardReset::checkSlider() const {
    const double fraction = newest_().state.target_speed_fraction;
    if (reporter_.latched() && fraction < kFullSpeed) {
        return refuse(
            fmt::format("the speed slider is at {:.0f} %: put it to 100 %", 100.0 * fraction));
    }
    return {};
}

Result<void> DashboardReset::await(const std::function<bool(const ControllerState&)>& reached,
                                   std::chrono::nanoseconds time, const std::string& what,
                                   const std::stop_token& stop) const {
    const auto deadline = std::chrono::steady_clock::now() + time;
    while (!stop.stop_requested()) {
        const auto now = newest_();
        if (now.connected && reached(now.state)) {
            return {};
        }
        if (std::chrono::steady_clock::now() >= deadline) {
            return fail(Errc::timeout, fmt::format("{}: {} within {:.0f} s", peer_.name, what,
                                                   std::chrono::duration<double>(time).count()));
        }
        link::waitFor(stop, kPoll);
    }
    return fail(Errc::cancelled, peer_.name + ": the driver was shut down");
}

}  // namespace metier::ur_driver
