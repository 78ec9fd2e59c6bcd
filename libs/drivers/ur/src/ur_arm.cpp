#include "ur_arm.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "described_model.hpp"
#include "metier/link/back_off.hpp"

namespace metier::ur_driver {

using namespace std::chrono_literals;
using device::SafetyState;

namespace {

constexpr auto kConnectTimeout = 2s;
constexpr auto kFirstPackage = 1s;  // longest time from the start of RTDE to its first data
constexpr std::size_t kMaxJobs = 16;
constexpr std::int32_t kLinkCycles = 3;

device::ArmInfo infoOf(const UrArmOptions& options) {
    device::ArmInfo info;
    info.name = options.name;
    for (const auto& joint : options.model.chain().joints) {
        info.axis_names.push_back(joint.name);
    }
    info.cycle = options.settings.cycle();
    return info;
}

/// Another one in every process, so that a script of the last one is not taken for ours.
std::int32_t firstToken() {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return static_cast<std::int32_t>(
        1 + std::chrono::duration_cast<std::chrono::milliseconds>(now).count() % 1'000'000'000);
}

}  // namespace

UrArm::UrArm(UrArmOptions options)
    : options_(std::move(options)),
      link_timeout_(options_.settings.link_timeout > 0ns ? options_.settings.link_timeout
                                                         : kLinkCycles * options_.settings.cycle()),
      core_(infoOf(options_)),
      jobs_(kMaxJobs),
      reporter_(core_, [this] { notifier_.signal(); }),
      streamer_(core_, options_.settings, options_.max_velocity, firstToken()),
      notifier_([this] { notify(); }),
      panel_(
          {jobs_, resets_, reporter_, [this](std::int32_t token) { streamer_.refuseStart(token); },
           [this] { return observed_.read(); }},
          {options_.name, options_.host}, options_.settings),
      primary_(options_.host, options_.settings.primary_port,
               [this](const primary::Package& package) { hear(package); }),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

// ---- control side ------------------------------------------------------------------------------

Result<void> UrArm::attach(std::shared_ptr<device::SetPointSource> source) {
    const auto now = observed_.read();
    if (core_.safetyState() == SafetyState::normal && now.connected) {
        const double fraction = now.state.target_speed_fraction;
        if (fraction < kFullSpeed) {
            return fail(Errc::device_fault,
                        fmt::format("{}: the speed slider is at {:.0f} %: put it to 100 %",
                                    options_.name, 100.0 * fraction));
        }
        const bool foreign = !streamer_.busy() &&
                             now.state.runtime_state == RuntimeState::playing &&
                             now.state.script_token != streamer_.token();
        if (foreign) {
            return fail(Errc::device_fault,
                        options_.name + ": another program runs on the controller: stop it there");
        }
    }
    return core_.attach(std::move(source));
}

Result<void> UrArm::resetFault() {
    // The safety state is normal before the paused program is ended.
    if (core_.safetyState() == SafetyState::normal && !resets_.underWay()) {
        return {};
    }
    if (core_.safetyState() == SafetyState::disconnected) {
        return fail(Errc::connection_lost, core_.safety().text);
    }
    const auto outcome = resets_.ask();
    if (!outcome) {
        return fail(Errc::timeout, fmt::format("{}: the reset goes on: try again ({})",
                                               options_.name, core_.safety().text));
    }
    return *outcome;
}

void UrArm::notify() {
    if (const auto token = upload_.exchange(0); token != 0) {
        jobs_.tryPush({PanelJob::Kind::upload, token});
    }
    if (stop_program_.exchange(false)) {
        jobs_.tryPush({PanelJob::Kind::stop_program, 0});
    }
    core_.dispatch();
}

void UrArm::hear(const primary::Package& package) {
    if (package.report) {
        reporter_.report(*package.report, std::chrono::steady_clock::now());
    }
    description_.take(package);
    const bool known = compared_.kinematics == description_.kinematics &&
                       compared_.configuration == description_.configuration;
    if (known || !description_.complete()) {
        return;
    }
    compared_ = description_;
    const auto difference = differenceText(options_.model, description_);
    if (!difference.empty()) {
        spdlog::warn("{}: {}", options_.name, difference);
    }
    reporter_.note(difference);
}

// ---- cycle thread ------------------------------------------------------------------------------

void UrArm::run(const std::stop_token& stop) {
    link::BackOff back_off;
    while (!stop.stop_requested()) {
        const RtdeRequest request{options_.host, options_.settings.rtde_port,
                                  options_.settings.frequency, options_.settings.register_base};
        auto session =
            RtdeSession::open(request, std::chrono::steady_clock::now() + kConnectTimeout);
        if (session) {
            back_off.reset();
            lost(serve(*session, stop));
            session->end(std::chrono::steady_clock::now() + link_timeout_);
        } else {
            lost(session.error());
        }
        back_off.wait(stop);
    }
}

Error UrArm::serve(RtdeSession& session, const std::stop_token& stop) {
    auto patience = std::chrono::nanoseconds(kFirstPackage);
    while (!stop.stop_requested()) {
        const auto now = session.next(std::chrono::steady_clock::now() + patience);
        if (!now && now.error().code == Errc::timeout) {
            return {Errc::timeout,
                    fmt::format("{}:{}: no RTDE data for {:.0f} ms", options_.host,
                                options_.settings.rtde_port,
                                std::chrono::duration<double, std::milli>(patience).count())};
        }
        if (!now) {
            return now.error();
        }
        patience = link_timeout_;
        if (auto done = cycle(session, *now); !done) {
            return done.error();
        }
    }
    return {Errc::cancelled, "the driver was shut down"};
}

Result<void> UrArm::cycle(RtdeSession& session, const ControllerState& now) {
    const auto stamp = std::chrono::steady_clock::now();
    reporter_.observe(now, streamer_.limitBroken(), stamp);
    const auto out = streamer_.cycle(now, stamp);
    observed_.write({now, true, core_.state().standstill});
    if (out.fault.kind != StreamFault::Kind::none) {
        reporter_.latch(toText(out.fault), stamp);
    }
    if (out.upload != 0) {
        upload_.store(out.upload);
    }
    if (out.stop_program) {
        stop_program_.store(true);
    }
    if (core_.toTell() || out.upload != 0 || out.stop_program) {
        notifier_.signal();
    }
    if (out.write) {
        return session.write(out.setpoint, stamp + link_timeout_);
    }
    return {};
}

void UrArm::lost(const Error& why) {
    reporter_.disconnected(why.message, std::chrono::steady_clock::now());
    observed_.write({});
    streamer_.disconnected();
    notifier_.signal();
}

}  // namespace metier::ur_driver
