// The driver of the Tern, a robot made up for docs/guide/add-a-robot.md. Its wire, TCP port 7300,
// lines of text, all angles in degrees:
//   controller, every 10 ms:  STATE RUN|STOP Q1 Q2 Q3 Q4 Q5 Q6
//   client:                   GO Q1 Q2 Q3 Q4 Q5 Q6
//                             BRAKE
//                             RESET
// A controller that hears nothing for 0.5 s while it moves brakes and is in STOP.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <string_view>
#include <thread>

#include "metier/device/arm_core.hpp"
#include "metier/device/driver.hpp"
#include "metier/device/notifier.hpp"
#include "metier/device/reset_slot.hpp"
#include "metier/link/back_off.hpp"
#include "metier/link/tcp_link.hpp"

namespace metier::tern_driver {
namespace {

using namespace std::chrono_literals;
using device::ArmState;
using device::EndCause;
using device::JointArray;
using device::SafetyState;

constexpr std::size_t kAxes = 6;
constexpr auto kCycle = 10ms;
constexpr auto kPauseBeforeRetry = 500ms;
constexpr auto kResetAnswer = 100ms;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kStandstill = 1e-3;  // [rad/s]

// ---- codec: bytes to structs, SI inside; no socket, no thread ----

struct State {
    bool running = false;
    JointArray position{kAxes};  ///< [rad]
};

/// Nothing if the line is not a whole STATE.
std::optional<State> stateOf(std::string_view line) {
    constexpr std::string_view kRun = "STATE RUN ";
    constexpr std::string_view kStop = "STATE STOP ";
    State state;
    state.running = line.starts_with(kRun);
    if (!state.running && !line.starts_with(kStop)) {
        return std::nullopt;
    }
    std::array<char, 160> text{};
    const auto rest = line.substr(state.running ? kRun.size() : kStop.size());
    rest.copy(text.data(), text.size() - 1);
    const char* at = text.data();
    for (auto& angle : state.position) {
        char* end = nullptr;
        angle = std::strtod(at, &end) * kDegree;
        if (end == at || !std::isfinite(angle)) {
            return std::nullopt;
        }
        at = end;
    }
    return state;
}

/// Writes "GO ..." without allocating. \return the bytes of `buffer` that hold it
std::span<const std::byte> goLine(const JointArray& target, std::span<char> buffer) {
    const auto end = fmt::format_to_n(
        buffer.data(), buffer.size(), "GO {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f}\n",
        target[0] / kDegree, target[1] / kDegree, target[2] / kDegree, target[3] / kDegree,
        target[4] / kDegree, target[5] / kDegree);
    return std::as_bytes(buffer.first(std::min(end.size, buffer.size())));
}

/// Takes lines out of a stream of bytes.
class Lines {
public:
    /// The next line, waiting for it. Errors: timeout, connection_lost.
    Result<std::string_view> next(link::TcpLink& link, SteadyTime deadline) {
        for (;;) {
            const std::string_view held(buffer_.data() + begin_, end_ - begin_);
            if (const auto length = held.find('\n'); length != std::string_view::npos) {
                begin_ += length + 1;
                return held.substr(0, length);
            }
            std::copy(buffer_.begin() + begin_, buffer_.begin() + end_, buffer_.begin());
            end_ -= begin_;
            begin_ = 0;
            if (end_ == buffer_.size()) {
                return fail(Errc::connection_lost, link.peer() + ": a line without an end");
            }
            const auto free = std::span(buffer_).subspan(end_);
            const auto count = link.receive(std::as_writable_bytes(free), deadline);
            if (!count) {
                return fail(count.error());
            }
            end_ += *count;
        }
    }

private:
    std::array<char, 1024> buffer_{};
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
};

// ---- session: one thread that talks to the controller, and is the arm's cycle ----

class TernArm final : public device::Arm {
public:
    TernArm(device::ArmInfo info, std::string address, std::uint16_t port,
            std::chrono::nanoseconds longest_silence)
        : core_(std::move(info)),
          address_(std::move(address)),
          port_(port),
          longest_silence_(longest_silence),
          notifier_([this] { core_.dispatch(); }),
          thread_([this](const std::stop_token& stop) { run(stop); }) {}

    const device::ArmInfo& info() const noexcept override { return core_.info(); }
    ArmState state() const noexcept override { return core_.state(); }
    device::Safety safety() const override { return core_.safety(); }
    Result<void> attach(std::shared_ptr<device::SetPointSource> source) override {
        return core_.attach(std::move(source));
    }
    void stop() noexcept override { core_.stop(); }
    Result<void> resetFault() override {
        if (core_.safetyState() == SafetyState::disconnected) {
            return fail(Errc::connection_lost, core_.safety().text);
        }
        if (core_.safetyState() == SafetyState::normal) {
            return {};
        }
        if (auto outcome = resets_.ask()) {
            return std::move(*outcome);
        }
        return fail(Errc::timeout, info().name + ": the reset goes on, ask again");
    }
    device::Registration onSafetyChange(SafetyCallback callback) override {
        return core_.onSafetyChange(std::move(callback));
    }

private:
    void run(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            auto link =
                link::TcpLink::connect(address_, port_, std::chrono::steady_clock::now() + 1s);
            auto why = link ? converse(*link, stop) : link.error();
            core_.setSafety({SafetyState::disconnected, info().name + ": " + why.message});
            endReset(fail(Errc::connection_lost, core_.safety().text));
            core_.end(EndCause::disconnected);
            notifier_.signal();
            link::waitFor(stop, kPauseBeforeRetry);
        }
    }

    /// \return why it ended
    Error converse(link::TcpLink& link, const std::stop_token& stop) {
        Lines lines;
        while (!stop.stop_requested()) {
            const auto now = std::chrono::steady_clock::now();
            const auto line = lines.next(link, now + longest_silence_);
            if (!line) {
                return line.error();
            }
            const auto state = stateOf(*line);
            if (!state) {
                return {Errc::connection_lost, link.peer() + ": sent what is no state"};
            }
            if (auto sent = cycle(*state, link); !sent) {
                return sent.error();
            }
        }
        return {Errc::cancelled, "the driver was shut down"};
    }

    /// Once per state of the controller. Neither allocates nor locks while nothing is wrong.
    Result<void> cycle(const State& state, link::TcpLink& link) {
        noteSafety(state);
        noteReset(state);
        publish(state);
        const auto deadline = std::chrono::steady_clock::now() + kCycle;
        if (resets_.taken()) {
            reset_deadline_ = std::chrono::steady_clock::now() + kResetAnswer;
            constexpr std::string_view kReset = "RESET\n";
            return link.send(std::as_bytes(std::span(kReset)), deadline);
        }
        auto* source = core_.active();
        if (source == nullptr) {
            return {};
        }
        auto target = state_.commanded_position;
        if (!state.running) {
            endAtStandstill(EndCause::safety);
        } else if (core_.stopRequested()) {
            endAtStandstill(EndCause::stopped);
            constexpr std::string_view kBrake = "BRAKE\n";
            return link.send(std::as_bytes(std::span(kBrake)), deadline);
        } else if (source->next(state_, target) == device::SetPointSource::Next::done) {
            core_.end(EndCause::done);
            notifier_.signal();
        } else {
            state_.commanded_position = target;
            std::array<char, 160> buffer{};
            return link.send(goLine(target, buffer), deadline);
        }
        return {};
    }

    void endAtStandstill(EndCause cause) noexcept {
        if (state_.standstill) {
            core_.end(cause);
            notifier_.signal();
        }
    }

    void noteSafety(const State& state) {
        const auto now = state.running ? SafetyState::normal : SafetyState::protective_stop;
        if (now == core_.safetyState()) {
            return;
        }
        core_.setSafety({now, state.running ? "" : info().name + ": the controller is in STOP"});
        notifier_.signal();
    }

    void noteReset(const State& state) {
        if (reset_deadline_ && state.running) {
            endReset({});
        } else if (reset_deadline_ && std::chrono::steady_clock::now() > *reset_deadline_) {
            endReset(fail(Errc::device_fault, core_.safety().text));
        }
    }

    void endReset(Result<void> outcome) {
        reset_deadline_.reset();
        resets_.answer(std::move(outcome));
    }

    void publish(const State& state) {
        const double cycle = info().cycleSeconds();
        for (std::size_t axis = 0; axis < kAxes; ++axis) {
            state_.velocity[axis] = (state.position[axis] - state_.position[axis]) / cycle;
        }
        state_.standstill =
            device::largestDifference(state.position, state_.position) / cycle < kStandstill;
        state_.position = state.position;
        if (core_.active() == nullptr) {
            state_.commanded_position = state.position;
        }
        ++state_.cycle;
        state_.stamp = std::chrono::steady_clock::now();
        core_.publish(state_);
    }

    device::ArmCore core_;
    const std::string address_;
    const std::uint16_t port_;
    const std::chrono::nanoseconds longest_silence_;
    ArmState state_{JointArray(kAxes), JointArray(kAxes), JointArray(kAxes)};  // of the thread
    std::optional<SteadyTime> reset_deadline_;  // of the reset that was sent
    device::ResetSlot resets_;
    device::Notifier notifier_;
    std::jthread thread_;
};

Result<device::OpenDevice> open(const device::OpenRequest& request) {
    const auto port = static_cast<std::uint16_t>(request.settings.numberOr("port", 7300, 1, 65535));
    // Silence of the controller after which it counts as gone [s]: three cycles, more for a
    // virtual one.
    const auto silence = request.settings.numberOr("longest_silence", 0.03, 0.03, 2.0);
    if (auto checked = request.settings.finish(); !checked) {
        return fail(checked.error());
    }
    if (request.model == nullptr || request.model->axisCount() != kAxes) {
        return fail(Errc::invalid_argument, request.name + ": a Tern has a model with six axes");
    }
    device::ArmInfo info{request.name, {}, kCycle};
    for (const auto& joint : request.model->chain().joints) {
        info.axis_names.push_back(joint.name);
    }
    // Shared as OpenDevice::owner says.
    auto arm = std::make_shared<TernArm>(
        std::move(info), request.address, port,
        std::chrono::round<std::chrono::nanoseconds>(std::chrono::duration<double>(silence)));
    device::OpenDevice device;
    device.arm = arm.get();
    device.owner = std::move(arm);
    return device;
}

}  // namespace
}  // namespace metier::tern_driver

namespace metier::device {

Driver ternDriver() {
    return {"tern", "The robot of docs/guide/add-a-robot.md: lines of text over TCP",
            tern_driver::open};
}

}  // namespace metier::device
