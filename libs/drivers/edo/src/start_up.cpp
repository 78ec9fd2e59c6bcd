#include "start_up.hpp"

#include "machine_text.hpp"
#include "metier/edo_driver/encoder.hpp"

namespace metier::edo_driver {
namespace {

using namespace std::chrono_literals;

constexpr auto kBeginTime = 2s;     // longest time from a command to a change of the machine state
constexpr auto kExecuteTime = 12s;  // the robot gives its joints 10 s
constexpr auto kSettleTime = 1s;    // longest time from NOT_CALIBRATED to CALIBRATED, if the joints
                                    // are calibrated

}  // namespace

void StartUp::start(SteadyTime now) {
    step_ = Step::deciding;
    init_sent_ = false;
    reset_sent_ = false;
    command_ = {};
    deadline_ = now + kSettleTime;
}

Result<void> StartUp::ended(Result<void> how) noexcept {
    step_ = Step::idle;
    return how;
}

std::optional<Result<void>> StartUp::tick(const MachineState& machine, SteadyTime now, Wire& wire) {
    switch (step_) {
        case Step::idle:
            return std::nullopt;
        case Step::sent:
            if (machine.state == sent_in_) {
                if (now < deadline_) {
                    return std::nullopt;
                }
                return ended(fail(Errc::device_fault,
                                  fmt::format("the robot dropped the {} without a word: still {}",
                                              command_, toText(machine))));
            }
            step_ = Step::executing;
            deadline_ = now + kExecuteTime;
            return tick(machine, now, wire);
        case Step::executing:
            if (machine.state == MachineState::command && now < deadline_) {
                return std::nullopt;
            }
            step_ = Step::deciding;
            deadline_ = now + kSettleTime;
            return decide(machine, now, wire);
        case Step::deciding:
            return decide(machine, now, wire);
    }
    return std::nullopt;
}

std::optional<Result<void>> StartUp::decide(const MachineState& machine, SteadyTime now,
                                            Wire& wire) {
    if (machine.state == MachineState::command && command_.empty()) {
        command_ = "command of somebody else";
        step_ = Step::executing;
        deadline_ = now + kExecuteTime;
        return std::nullopt;
    }
    if (machine.state == MachineState::init && !init_sent_) {
        init_sent_ = true;
        deadline_ = now + kBeginTime;
        send("start-up", initText(layout_), machine, wire);
        return std::nullopt;
    }
    if (machine.state == MachineState::braked && !reset_sent_) {
        reset_sent_ = true;
        deadline_ = now + kBeginTime;
        send("reset", resetText(layout_, request_), machine, wire);
        return std::nullopt;
    }
    const auto safety = safetyOf(machine);
    if (safety.state == device::SafetyState::normal) {
        return ended({});
    }
    // A state on the way to CALIBRATED.
    const bool passing =
        machine.state == MachineState::not_calibrated || machine.state == MachineState::calibrated;
    if (passing && now < deadline_) {
        return std::nullopt;
    }
    return ended(fail(Errc::device_fault, safety.text));
}

void StartUp::send(std::string_view what, const std::string& text, const MachineState& machine,
                   Wire& wire) {
    command_ = what;
    sent_in_ = machine.state;
    step_ = Step::sent;
    wire.send(text);
}

}  // namespace metier::edo_driver
