#include "session.hpp"

#include <spdlog/spdlog.h>

#include <array>
#include <cmath>
#include <utility>

#include "decoder.hpp"

namespace metier::edo_driver {

using device::SafetyState;

namespace {

using namespace std::chrono_literals;

constexpr auto kVersionTime = 3s;
// Without any message for so long another connection is tried.
constexpr auto kDeafTime = 3s;
// No axis turns further, no jaws open wider: what says so is garbage [rad], [m].
constexpr double kLargestPosition = 6.3;
constexpr std::string_view kVersionCall = "metier-version";

using Topic = std::pair<std::string_view, std::string_view>;
constexpr std::array<Topic, 3> kWritten{Topic{"/bridge_init", "edo_core_msgs/JointInit"},
                                        {"/bridge_jnt_reset", "edo_core_msgs/JointReset"},
                                        {"/bridge_move", "edo_core_msgs/MovementCommand"}};
constexpr std::array<Topic, 4> kRead{Topic{"/machine_state", "edo_core_msgs/MachineState"},
                                     {"/usb_jnt_state", "edo_core_msgs/JointStateArray"},
                                     {"/algorithm_state", "std_msgs/Int8"},
                                     {"/machine_movement_ack", "edo_core_msgs/MovementFeedback"}};

void subscribe(Wire& wire) {
    for (const auto& [topic, type] : kWritten) {
        wire.send(advertiseText(topic, type));
    }
    for (const auto& [topic, type] : kRead) {
        wire.send(subscribeText(topic, type));
    }
}

}  // namespace

Session::Session(const EdoOptions& options, device::ArmCore& core)
    : options_(options),
      core_(core),
      safety_(options, core),
      arm_(options, core, safety_),
      gripper_(options),
      start_up_(options_.layout, options.reset) {}

void Session::linkUp(SteadyTime now, Wire& wire) {
    phase_ = Phase::asking;
    complained_ = false;
    heard_at_ = now;
    answer_by_ = now + kVersionTime;
    safety_.linkLost("connected, the robot's software version is not known yet");
    wire.send(softwareVersionCallText(kVersionCall));
    if (options_.generation) {
        begin(*options_.generation, now, wire);
    }
}

void Session::begin(const Generation& generation, SteadyTime now, Wire& wire) {
    phase_ = Phase::up;
    arm_.connected(generation);
    safety_.linkFound(now);
    wire.send(advertiseText(generation.setPointTopic(), generation.setPointType()));
    subscribe(wire);
}

void Session::linkDown(const std::string& why) {
    if (std::exchange(phase_, Phase::down) == Phase::up) {
        spdlog::warn("{}: link lost: {}", options_.name, why);
    }
    letGo(why);
}

void Session::letGo(const std::string& why) {
    phase_ = Phase::down;
    safety_.linkLost(why);
    arm_.disconnected();
    loseGripper(Errc::connection_lost);
    endReset(fail(Errc::connection_lost, core_.safety().text));
}

void Session::onText(std::string_view text, SteadyTime now, Wire& wire) {
    heard_at_ = now;
    const auto message = decode(text, options_.layout);
    if (!message) {
        if (!std::exchange(complained_, true)) {
            spdlog::warn("{}: a message was not understood: {}", options_.name,
                         message.error().message);
        }
        return;
    }
    std::visit([&](const auto& content) { on(content, now, wire); }, *message);
}

bool Session::valid(const JointStates& states) const noexcept {
    if (states.count != options_.layout.count()) {
        return false;
    }
    for (std::size_t joint = 0; joint < states.count; ++joint) {
        if (!(std::abs(states.joints[joint].position) <= kLargestPosition)) {
            return false;
        }
    }
    return true;
}

void Session::on(const JointStates& states, SteadyTime now, Wire& wire) {
    if (phase_ != Phase::up) {
        return;
    }
    if (!valid(states)) {
        // While a source moves the arm, it counts as silence, which ends the motion.
        if (states.count != options_.layout.count() && core_.active() == nullptr) {
            safety_.onJointStates(states.count, now);
        }
        return;
    }
    safety_.onJointStates(states.count, now);
    if (options_.layout.gripper) {
        gripper_.onJoint(states.joints[options_.layout.axes], now);
    }
    arm_.onJointStates(states, now, wire);
    publishGripper(now);
}

void Session::on(const MachineState& machine, SteadyTime now, Wire&) {
    if (phase_ != Phase::up) {
        return;
    }
    safety_.onMachineState(machine, now);
    if (options_.start_on_connect && !std::exchange(started_once_, true) &&
        core_.safetyState() != SafetyState::normal) {
        startReset();
    }
}

void Session::on(const AlgorithmState& state, SteadyTime now, Wire&) {
    arm_.onAlgorithmState(state, now);
}

void Session::on(const MovementFeedback& feedback, SteadyTime, Wire&) {
    gripper_.onFeedback(feedback);
}

void Session::on(const ServiceResponse& response, SteadyTime now, Wire& wire) {
    if (response.id != kVersionCall) {
        arm_.onResponse(response, now);
        return;
    }
    if (phase_ != Phase::asking) {
        return;
    }
    const auto generation = generationOf(response.software.value_or(response.text));
    begin(generation.value_or(classicGeneration()), now, wire);
    if (!generation) {
        safety_.unusable(generation.error().message);
    }
}

void Session::on(const Status& status, SteadyTime, Wire&) {
    if (status.level == "error" || status.level == "warning") {
        spdlog::warn("{}: rosbridge {}: {}", options_.name, status.level, status.text);
    }
}

Result<void> Session::tick(SteadyTime now, Wire& wire) {
    if (phase_ == Phase::asking && now >= answer_by_) {
        return fail(Errc::connection_lost,
                    "no answer of /machine_bridge_sw_version_srv within 3 s; "
                    "`generation` = classic or external would go on without it");
    }
    if (phase_ != Phase::up) {
        return {};
    }
    if (now - heard_at_ > kDeafTime) {
        return fail(Errc::connection_lost, "no message within 3 s");
    }
    safety_.tick(now);
    arm_.tick(now);
    tickReset(now, wire);
    tickGripper(now, wire);
    const bool elsewhere = closing_ || reset_ != Reset::none || gripper_slot_.waiting();
    arm_.setWanted(elsewhere ? ArmDrive::Wanted::elsewhere : ArmDrive::Wanted::for_sources);
    return {};
}

void Session::close() noexcept {
    closing_ = true;
    core_.stop();
}

// ---- reset -------------------------------------------------------------------------------------

void Session::startReset() {
    if (reset_ == Reset::none) {
        reset_ = Reset::freeing;
    }
}

void Session::tickReset(SteadyTime now, Wire& wire) {
    if (reset_slot_.taken()) {
        startReset();
    }
    if (reset_ == Reset::none) {
        return;
    }
    if (core_.safetyState() == SafetyState::normal) {
        endReset({});
        return;
    }
    if (reset_ == Reset::freeing && arm_.free()) {
        reset_ = Reset::giving_back;
        if (safety_.hasFault()) {
            arm_.giveBackLeftover(now, wire);
        }
    }
    if (reset_ == Reset::giving_back && arm_.free()) {
        reset_ = Reset::recovering;
        start_up_.start(now);
    }
    if (reset_ == Reset::recovering && safety_.machine()) {
        if (auto outcome = start_up_.tick(*safety_.machine(), now, wire)) {
            endReset(std::move(*outcome));
        }
    }
}

void Session::endReset(Result<void> outcome) {
    start_up_.cancel();
    reset_ = Reset::none;
    if (outcome) {
        safety_.clearFault();
        if (const auto safety = core_.safety(); safety.state != SafetyState::normal) {
            outcome = fail(Errc::device_fault, safety.text);
        }
    } else if (outcome.error().code == Errc::device_fault) {
        outcome = fail(Errc::device_fault, options_.name + ": " + outcome.error().message);
    }
    reset_slot_.answer(std::move(outcome));
}

// ---- gripper -----------------------------------------------------------------------------------

void Session::tickGripper(SteadyTime now, Wire& wire) {
    if (gripper_slot_.posted() == nullptr) {
        return;
    }
    if (core_.safetyState() != SafetyState::normal) {
        loseGripper(core_.safetyState() == SafetyState::disconnected ? Errc::connection_lost
                                                                     : Errc::device_fault);
        return;
    }
    const bool stop = gripper_slot_.takeStop();
    if (gripper_slot_.waiting()) {
        if (stop) {
            gripper_slot_.end(fail(Errc::cancelled, options_.name + " gripper: stopped"));
        } else if (arm_.free()) {
            gripper_.start(*gripper_slot_.take(), arm_.holding(), now, wire);
        }
        return;
    }
    if (stop) {
        gripper_.stop(now, wire);
    }
    if (auto outcome = gripper_.tick(*safety_.machine(), now, wire)) {
        publishGripper(now);  // first, so that an observer of the end sees the jaws at rest
        gripper_slot_.end(std::move(*outcome));
    }
}

void Session::loseGripper(Errc code) {
    gripper_.abandon();
    gripper_slot_.end(fail(code, core_.safety().text));
}

void Session::publishGripper(SteadyTime now) noexcept {
    device::GripperState state;
    state.width = gripper_.width();
    state.moving = gripper_.moving();
    state.part_held = gripper_.partHeld();
    state.stamp = now;
    gripper_state_.write(state);
}

}  // namespace metier::edo_driver
