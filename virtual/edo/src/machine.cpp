#include "machine.hpp"

#include <algorithm>
#include <bit>

namespace metier::virtual_edo {
namespace {

// In cycles of 10 ms.
constexpr int kVersionsTime = 10;
constexpr int kMostUnheard = 20;
constexpr int kLongestSilence = 300;
constexpr int kHeartbeatTime = 100;
constexpr int kBrakesCheckTime = 500;

constexpr std::uint8_t kAllBrakesHold = 7;

}  // namespace

void CommandWait::begin(std::uint64_t mask, std::size_t axes) {
    age_ = 0;
    for (std::size_t axis = 0; axis < phases_.size(); ++axis) {
        phases_[axis] = axis < axes && inMask(mask, axis) ? Phase::low : Phase::done;
    }
}

bool CommandWait::take(const BusReport& report) {
    for (std::size_t axis = 0; axis < std::min(phases_.size(), report.joints.size()); ++axis) {
        if (!inMask(report.mask, axis)) {
            continue;
        }
        const bool raised = (report.joints[axis].flags & 0x000FU) != 0;
        if (phases_[axis] == Phase::low && raised) {
            phases_[axis] = Phase::raised;
        } else if (phases_[axis] == Phase::raised && !raised) {
            phases_[axis] = Phase::done;
        }
    }
    return std::all_of(phases_.begin(), phases_.end(),
                       [](Phase phase) { return phase == Phase::done; });
}

void Machine::set(Opcode bit, bool on) {
    const std::uint32_t mask = 1U << static_cast<unsigned>(bit);
    opcode_ = on ? opcode_ | mask : opcode_ & ~mask;
}

void Machine::makeReady(std::size_t axes) {
    axes_ = peers_.loadConfiguration(axes);
    enter(MachineState::calibrated);
}

void Machine::onInit(std::uint8_t mode, std::uint64_t mask) {
    if (state_ != MachineState::init && state_ != MachineState::calibrated) {
        return;
    }
    if (state_ == MachineState::init && mode == static_cast<std::uint8_t>(InitMode::discovery)) {
        discover(mask);
    } else if (state_ == MachineState::calibrated ||
               mode != static_cast<std::uint8_t>(InitMode::mask_joints)) {
        beginCommand(Pending::other, mask, axes_);
        peers_.bus().touch(mask);
    }
}

void Machine::discover(std::uint64_t mask) {
    const auto requested = static_cast<std::size_t>(std::popcount(mask));
    axes_ = peers_.loadConfiguration(requested);
    complete_ = axes_ == requested;
    beginCommand(Pending::discovery, mask, axes_);
    peers_.bus().discover(mask);
}

void Machine::onReset(std::uint64_t mask) {
    if (state_ == MachineState::braked) {
        beginCommand(Pending::reset, mask, std::min(axes_, kArmAxes));
        peers_.bus().reset(mask);
    }
}

void Machine::onCalibration(std::uint64_t mask) {
    if (state_ == MachineState::not_calibrated || state_ == MachineState::calibrated) {
        beginCommand(Pending::other, mask, std::min(axes_, kArmAxes));
        peers_.bus().calibrate(mask);
    }
}

void Machine::onConfiguration(std::uint64_t mask) {
    if (state_ == MachineState::calibrated) {
        beginCommand(Pending::other, mask, std::min(axes_, kArmAxes));
        peers_.bus().configure(mask);
    }
}

void Machine::beginCommand(Pending pending, std::uint64_t mask, std::size_t awaited) {
    if (state_ != MachineState::command) {
        previous_ = state_;
    }
    pending_ = pending;
    wait_.begin(mask, awaited);
    enter(MachineState::command);
}

void Machine::stepCommand(const std::optional<BusReport>& report) {
    if (pending_ == Pending::versions) {
        if (--versions_left_ <= 0) {
            beginCommand(Pending::configuration, maskOf(axes_), std::min(axes_, kArmAxes));
            peers_.bus().configure(maskOf(axes_));
        }
        return;
    }
    if (wait_.expired()) {
        expireCommand();
    } else if (axes_ > 0 && report && report->joints.size() == axes_ && wait_.take(*report)) {
        finishCommand();
    }
}

void Machine::finishCommand() {
    switch (std::exchange(pending_, Pending::nothing)) {
        case Pending::discovery:
            if (complete_) {
                pending_ = Pending::versions;
                versions_left_ = kVersionsTime;
            } else {
                enter(MachineState::init);
            }
            break;
        case Pending::configuration:
        case Pending::reset:
            enter(MachineState::not_calibrated);
            break;
        default:
            enter(previous_);
            break;
    }
}

void Machine::expireCommand() {
    pending_ = Pending::nothing;
    if (previous_ == MachineState::init) {
        enter(MachineState::init);
        return;
    }
    set(Opcode::no_acknowledgement, true);
    stop();
}

void Machine::step(const std::optional<BusReport>& report, bool collision) {
    stepSilence(report);
    if (report && axes_ > 0 && report->joints.size() == axes_) {
        judge(readFlags(*report), collision);
    }
    set(Opcode::emergency_stop, peers_.bus().emergencyStop());
    if (state_ == MachineState::command) {
        stepCommand(report);
    }
    if (state_ == MachineState::brakes_check) {
        stepBrakesCheck();
    }
    constexpr int kJogTime = 15;
    if (state_ == MachineState::jog && ++jog_age_ > kJogTime) {
        stopJog();
    }
}

void Machine::stepSilence(const std::optional<BusReport>& report) {
    silence_ = report ? 0 : silence_ + 1;
    if (silence_ == kLongestSilence && state_ != MachineState::init) {
        set(Opcode::joint_absent, true);
        stop();
    }
}

Machine::Flags Machine::readFlags(const BusReport& report) {
    Flags flags;
    for (std::size_t axis = 0; axis < report.joints.size(); ++axis) {
        const auto& joint = report.joints[axis];
        unheard_[axis] = inMask(report.mask, axis) ? 0 : unheard_[axis] + 1;
        flags.overcurrent = flags.overcurrent || joint.has(JointFlag::overcurrent);
        flags.uncalibrated = flags.uncalibrated || joint.has(JointFlag::uncalibrated);
        flags.power_stage_open = flags.power_stage_open || joint.has(JointFlag::power_stage_open);
    }
    return flags;
}

void Machine::judge(const Flags& flags, bool collision) {
    set(Opcode::overcurrent, flags.overcurrent);
    set(Opcode::brake_active, flags.power_stage_open && state_ != MachineState::braked);
    set(Opcode::uncalibrated, flags.uncalibrated);
    set(Opcode::joint_absent, std::any_of(unheard_.begin(), unheard_.end(),
                                          [](int cycles) { return cycles >= kMostUnheard; }));
    if (flags.uncalibrated && state_ == MachineState::calibrated) {
        enter(MachineState::not_calibrated);
    }
    if (heartbeatLost() || collision || flags.power_stage_open) {
        brake();
    }
    if (flags.overcurrent && state_ != MachineState::init && state_ != MachineState::error) {
        stop();
    }
    if (state_ == MachineState::not_calibrated && !flags.uncalibrated) {
        enter(MachineState::calibrated);
    }
}

bool Machine::mayBrake() const {
    return state_ == MachineState::not_calibrated || state_ == MachineState::calibrated ||
           state_ == MachineState::move || state_ == MachineState::jog ||
           state_ == MachineState::brakes_check;
}

void Machine::brake() {
    if (!mayBrake()) {
        return;
    }
    if (state_ == MachineState::brakes_check) {
        peers_.publishBrakesCheck(2, 0);
    }
    set(Opcode::brake_active, true);
    moves_.clear();
    enter(MachineState::braked);
    peers_.bus().brake();
    peers_.onBraked();
}

void Machine::stop() {
    moves_.clear();
    enter(MachineState::error);
    peers_.bus().brake();
    peers_.onBraked();
}

void Machine::onHeartbeatStart(bool start) {
    heartbeat_wanted_ = start;
    heartbeat_age_ = 0;
    beats_ = 0;
}

bool Machine::heartbeatLost() {
    if (!heartbeat_wanted_ || ++heartbeat_age_ < kHeartbeatTime) {
        return false;
    }
    const bool lost = beats_ == 0;
    heartbeat_wanted_ = !lost;
    heartbeat_age_ = 0;
    beats_ = 0;
    return lost;
}

void Machine::onBrakesCheckStart(bool start) {
    if (start && state_ == MachineState::calibrated) {
        peers_.publishBrakesCheck(0, 0);
        brakes_check_left_ = kBrakesCheckTime;
        enter(MachineState::brakes_check);
    }
}

void Machine::stepBrakesCheck() {
    if (--brakes_check_left_ <= 0) {
        peers_.publishBrakesCheck(1, kAllBrakesHold);
        enter(MachineState::calibrated);
    }
}

}  // namespace metier::virtual_edo
