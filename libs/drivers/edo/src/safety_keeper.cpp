#include "safety_keeper.hpp"

#include "machine_text.hpp"

namespace metier::edo_driver {

using device::Safety;
using device::SafetyState;

namespace {

double milliseconds(Duration duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace

void SafetyKeeper::linkLost(const std::string& why) {
    link_problem_ = why;
    unusable_.reset();
    machine_.reset();
    robot_allows_ = false;
    machine_silent_ = true;
    joints_silent_ = true;
    tell();
}

void SafetyKeeper::linkFound(SteadyTime now) {
    link_problem_.reset();
    machine_heard_ = now;
    joints_heard_ = now;
    tell();
}

void SafetyKeeper::unusable(const std::string& why) {
    unusable_ = why;
    tell();
}

void SafetyKeeper::onMachineState(const MachineState& machine, SteadyTime now) {
    machine_heard_ = now;
    if (machine_ == machine && !machine_silent_) {
        return;
    }
    machine_silent_ = false;
    machine_ = machine;
    robot_ = safetyOf(machine);
    robot_allows_ = robot_.state == SafetyState::normal;
    tell();
}

void SafetyKeeper::onJointStates(std::size_t count, SteadyTime now) {
    joints_heard_ = now;
    if (!joints_silent_ && count == joint_count_) {
        return;
    }
    joints_silent_ = false;
    joint_count_ = count;
    tell();
}

void SafetyKeeper::tick(SteadyTime now) {
    const bool machine = machine_silent_ || now - machine_heard_ > options_.machine_timeout;
    const bool joints = joints_silent_ || now - joints_heard_ > options_.joint_timeout;
    if (machine != machine_silent_ || joints != joints_silent_) {
        machine_silent_ = machine;
        joints_silent_ = joints;
        tell();
    }
}

void SafetyKeeper::fault(const std::string& why, Limit limit) {
    if (fault_.empty()) {
        fault_ = why;
        limit_ = limit;
        tell();
    }
}

void SafetyKeeper::clearFault() {
    fault_.clear();
    limit_ = Limit::kept;
    tell();
}

void SafetyKeeper::tell() {
    auto now = gravest();
    if (!now.text.empty()) {
        now.text = options_.name + ": " + now.text;
    }
    if (now.state != reported_.state || now.text != reported_.text) {
        reported_ = now;
        core_.setSafety(std::move(now));
    }
}

Safety SafetyKeeper::gravest() const {
    if (link_problem_) {
        return {SafetyState::disconnected, *link_problem_};
    }
    if (unusable_) {
        return {SafetyState::fault, *unusable_};
    }
    if (auto silent = silence(); silent.state != SafetyState::normal) {
        return silent;
    }
    if (!robot_allows_) {
        return robot_;
    }
    if (joint_count_ != options_.layout.count()) {
        return {SafetyState::fault,
                fmt::format("the robot has {} joints, the settings say {} axes {} gripper",
                            joint_count_, options_.layout.axes,
                            options_.layout.gripper ? "and a" : "without a")};
    }
    if (!fault_.empty()) {
        return {SafetyState::protective_stop, fault_, limit_ == Limit::violated};
    }
    return {};
}

Safety SafetyKeeper::silence() const {
    if (machine_silent_) {
        return {SafetyState::disconnected, machine_
                                               ? fmt::format("no machine state for {} ms",
                                                             milliseconds(options_.machine_timeout))
                                               : std::string("no machine state yet")};
    }
    // Joints that were not discovered yet do not report.
    const bool started =
        machine_->state != MachineState::init && machine_->state != MachineState::command;
    if (joints_silent_ && started) {
        return {SafetyState::disconnected,
                fmt::format("no joint states for {} ms", milliseconds(options_.joint_timeout))};
    }
    return {};
}

}  // namespace metier::edo_driver
