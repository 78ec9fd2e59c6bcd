#include "fake_robot.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace metier::urscript {
namespace {

template <typename Array, typename T>
Result<void> write(Array& registers, int index, T value) {
    if (index < 0 || static_cast<std::size_t>(index) >= registers.size()) {
        return fail(Errc::out_of_range, "no register " + std::to_string(index));
    }
    registers[static_cast<std::size_t>(index)] = value;
    return {};
}

template <typename Array>
Result<typename Array::value_type> read(const Array& registers, int index) {
    if (index < 0 || static_cast<std::size_t>(index) >= registers.size()) {
        return fail(Errc::out_of_range, "no register " + std::to_string(index));
    }
    return registers[static_cast<std::size_t>(index)];
}

template <typename Map, typename Port>
Result<typename Map::mapped_type> pin(const Map& pins, Port port, int index) {
    constexpr int kMost = 8;
    if (index < 0 || index >= kMost) {
        return fail(Errc::out_of_range, "no pin " + std::to_string(index));
    }
    const auto found = pins.find({port, index});
    return found == pins.end() ? typename Map::mapped_type{} : found->second;
}

}  // namespace

void FakeSockets::open(const std::string& name, const std::string& host, int port) {
    all[name] = Socket{first_state, host, port, {}, first_received};
}

SocketState FakeSockets::state(const std::string& name) const {
    const auto found = all.find(name);
    return found == all.end() ? SocketState::closed : found->second.state;
}

bool FakeSockets::send(const std::string& name, std::string_view bytes) {
    if (state(name) != SocketState::open) {
        return false;
    }
    all[name].sent += bytes;
    return true;
}

std::string_view FakeSockets::received(const std::string& name) const {
    const auto found = all.find(name);
    return found == all.end() ? std::string_view() : std::string_view(found->second.received);
}

void FakeSockets::consume(const std::string& name, std::size_t count) {
    all.at(name).received.erase(0, count);
}

Result<Vector6> FakeRobot::jointPositionHistory(int cycles) const {
    Vector6 position = now.actual_joint_position;
    position[0] -= cycles;
    return position;
}

Result<void> FakeRobot::beginMotion(const Motion& motion) {
    if (!refusal.empty()) {
        return fail(Errc::device_fault, refusal);
    }
    motions.push_back(motion);
    cycles_left_ = motion_cycles;
    return {};
}

Result<bool> FakeRobot::motionDone() {
    if (!refusal.empty()) {
        return fail(Errc::device_fault, refusal);
    }
    --cycles_left_;
    return cycles_left_ <= 0;
}

Result<void> FakeRobot::apply(const Command& command) {
    commands.push_back(command);
    return {};
}

int FakeRobot::toolContact(const Vector6& direction) const {
    return direction == Vector6{} ? 0 : contact;
}

Result<Vector6> FakeRobot::inverseKinematics(const Pose& base_from_tool, const Vector6& near,
                                             const Pose& flange_from_tool) const {
    constexpr double kReach = 1.0;
    if (base_from_tool.value[0] > kReach) {
        return fail(Errc::unreachable, "out of reach");
    }
    Vector6 position = near;
    position[0] = base_from_tool.value[0] - flange_from_tool.value[0];
    return position;
}

Result<Pose> FakeRobot::forwardKinematics(const Vector6& joint_position,
                                          const Pose& flange_from_tool) const {
    Pose pose;
    pose.value[0] = joint_position[0] + flange_from_tool.value[0];
    return pose;
}

bool FakeRobot::withinLimits(const Target& target) const {
    const auto* pose = std::get_if<Pose>(&target);
    return pose != nullptr ? inverseKinematics(*pose, {}, {}).has_value()
                           : std::abs(std::get<Vector6>(target)[0]) < 1.0;
}

Result<std::int32_t> FakeRobot::integerRegister(RegisterBank bank, int index) const {
    return read(bank == RegisterBank::input ? input_integers : output_integers, index);
}

Result<double> FakeRobot::floatRegister(RegisterBank bank, int index) const {
    return read(bank == RegisterBank::input ? input_floats : output_floats, index);
}

Result<bool> FakeRobot::bitRegister(RegisterBank bank, int index) const {
    const auto found = bits.find({bank, index});
    return found != bits.end() && found->second;
}

Result<void> FakeRobot::writeIntegerRegister(int index, std::int32_t value) {
    return write(output_integers, index, value);
}

Result<void> FakeRobot::writeFloatRegister(int index, double value) {
    return write(output_floats, index, value);
}

Result<void> FakeRobot::writeBitRegister(int index, bool value) {
    bits[{RegisterBank::output, index}] = value;
    return {};
}

Result<bool> FakeRobot::digitalInput(DigitalPort port, int index) const {
    return pin(inputs, port, index);
}

Result<bool> FakeRobot::digitalOutput(DigitalPort port, int index) const {
    return pin(outputs, port, index);
}

Result<void> FakeRobot::setDigitalOutput(DigitalPort port, int index, bool value) {
    outputs[{port, index}] = value;
    return {};
}

Result<double> FakeRobot::analogInput(AnalogPort port, int index) const {
    return pin(analog_inputs, port, index);
}

Result<double> FakeRobot::analogOutput(AnalogPort port, int index) const {
    return pin(analog_outputs, port, index);
}

Result<void> FakeRobot::setAnalogOutput(AnalogPort port, int index, double share) {
    analog_outputs[{port, index}] = share;
    return {};
}

void FakeRobot::showPopup(const Popup& popup) {
    popups.push_back(popup);
    popup_open = popup.blocking;
}

Program parsed(std::string_view text) {
    auto program = Program::parse(text);
    if (!program) {
        throw std::invalid_argument(program.error().message);
    }
    return *program;
}

std::string parseError(std::string_view text) {
    const auto program = Program::parse(text);
    return program ? "" : program.error().message;
}

std::string within(std::string_view statements) {
    return fmt::format("def test():\n{}\nend\n", statements);
}

std::string resultOf(std::string_view statements) {
    FakeRobot robot;
    return resultOf(statements, robot);
}

std::string resultOf(std::string_view statements, FakeRobot& robot) {
    constexpr int kMostCycles = 1000;
    Interpreter interpreter(parsed(within(statements)), robot);
    for (int i = 0; i < kMostCycles && interpreter.step() == RunState::running; ++i) {
    }
    if (const auto& exception = interpreter.exception()) {
        return fmt::format("{}:{} {}", exception->line, exception->column, exception->text);
    }
    if (interpreter.state() == RunState::running) {
        return "still running";
    }
    const auto result = interpreter.variable("result");
    return result ? result->text() : "no result";
}

}  // namespace metier::urscript
