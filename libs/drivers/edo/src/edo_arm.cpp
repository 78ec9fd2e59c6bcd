#include "edo_arm.hpp"

#include <utility>

#include "metier/link/back_off.hpp"
#include "wire.hpp"

namespace metier::edo_driver {

using device::SafetyState;

namespace {

using namespace std::chrono_literals;

constexpr auto kConnectTime = 1s;
constexpr auto kSendTime = 100ms;
// Longest wait for a message; the robot sends one each 10 ms at least.
constexpr auto kTick = 20ms;
constexpr auto kCloseTime = 2s;

SteadyTime now() {
    return std::chrono::steady_clock::now();
}

device::ArmInfo infoFor(const EdoOptions& options) {
    return {options.name, options.axis_names, EdoOptions::kCycle};
}

}  // namespace

/// Sends through the link and keeps the first failure.
class EdoArm::LinkWire final : public Wire {
public:
    explicit LinkWire(WebSocketLink& link) : link_(link) {}

    void send(std::string_view text) noexcept override {
        if (state_) {
            state_ = link_.send(text, now() + kSendTime);
        }
    }
    const Result<void>& state() const noexcept { return state_; }

private:
    WebSocketLink& link_;
    Result<void> state_;
};

EdoArm::EdoArm(EdoOptions options)
    : options_(std::move(options)),
      core_(infoFor(options_)),
      session_(options_, core_),
      notifier_([this] {
          core_.dispatch();
          session_.gripperSlot().dispatch();
      }),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

EdoArm::~EdoArm() {
    thread_.request_stop();
    thread_.join();
}

Result<void> EdoArm::attach(std::shared_ptr<device::SetPointSource> source) {
    const std::lock_guard lock(turn_);
    if (session_.gripperSlot().occupied()) {
        return fail(Errc::resource_unavailable, options_.name + ": the gripper moves");
    }
    return core_.attach(std::move(source));
}

Result<void> EdoArm::moveJaws(GripperTask::Kind kind, const device::GripperRequest& request,
                              device::Gripper::Done done) {
    const auto task = taskFor(kind, request, options_.gripper);
    if (!task) {
        return fail(task.error().code, options_.name + " gripper: " + task.error().message);
    }
    const std::lock_guard lock(turn_);
    if (const auto safety = core_.safety(); safety.state != SafetyState::normal) {
        const bool lost = safety.state == SafetyState::disconnected;
        return fail(lost ? Errc::connection_lost : Errc::device_fault, safety.text);
    }
    if (core_.active() != nullptr) {
        return fail(Errc::resource_unavailable, options_.name + " gripper: the arm moves");
    }
    return session_.gripperSlot().post(*task, std::move(done));
}

device::GripperState EdoArm::gripperState() const noexcept {
    auto state = session_.gripperState();
    state.safety = core_.safetyState();
    return state;
}

Result<void> EdoArm::resetFault() {
    const auto safety = core_.safety();
    if (safety.state == SafetyState::normal) {
        return {};
    }
    if (safety.state == SafetyState::disconnected) {
        return fail(Errc::connection_lost, safety.text);
    }
    const auto outcome = session_.resetSlot().ask();
    if (!outcome) {
        return fail(Errc::timeout, fmt::format("{}: the reset goes on, ask again ({})",
                                               options_.name, core_.safety().text));
    }
    return *outcome;
}

// ---- cycle thread ------------------------------------------------------------------------------

void EdoArm::run(const std::stop_token& stop) {
    link::BackOff back_off;
    while (!stop.stop_requested()) {
        auto link = WebSocketLink::connect(options_.host, options_.port, now() + kConnectTime);
        Result<void> served = link ? serve(*link, stop) : fail(link.error());
        if (served) {
            break;
        }
        if (link) {
            back_off.reset();
        }
        session_.linkDown(served.error().message);
        tell();
        back_off.wait(stop);
    }
    session_.letGo("the driver was shut down");
    tell();
}

/// \return nothing once the driver is to end, else why the link is of no use any more
Result<void> EdoArm::serve(WebSocketLink& link, const std::stop_token& stop) {
    LinkWire wire(link);
    session_.linkUp(now(), wire);
    while (!stop.stop_requested()) {
        METIER_TRY(step(link, wire));
    }
    close(link, wire);
    return {};
}

Result<void> EdoArm::step(WebSocketLink& link, LinkWire& wire) {
    const auto text = link.receive(now() + kTick);
    if (text) {
        session_.onText(*text, now(), wire);
    } else if (text.error().code != Errc::timeout) {
        return fail(text.error());
    }
    if (auto ticked = session_.tick(now(), wire); !ticked) {
        return fail(ticked.error().code, link.peer() + ": " + ticked.error().message);
    }
    tell();
    return wire.state();
}

void EdoArm::close(WebSocketLink& link, LinkWire& wire) {
    const auto deadline = now() + kCloseTime;
    while (!session_.closed() && now() < deadline) {
        session_.close();
        if (!step(link, wire)) {
            return;
        }
    }
}

void EdoArm::tell() noexcept {
    if (core_.toTell() || session_.gripperSlot().toTell()) {
        notifier_.signal();
    }
}

}  // namespace metier::edo_driver
