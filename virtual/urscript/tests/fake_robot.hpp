#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metier/urscript/interpreter.hpp"

namespace metier::urscript {

/// Sockets that a test opens, fills and reads by hand.
class FakeSockets final : public Sockets {
public:
    struct Socket {
        SocketState state = SocketState::opening;
        std::string host;
        int port = 0;
        std::string sent;
        std::string received;
    };

    void open(const std::string& name, const std::string& host, int port) override;
    SocketState state(const std::string& name) const override;
    void close(const std::string& name) override { all.erase(name); }
    bool send(const std::string& name, std::string_view bytes) override;
    std::string_view received(const std::string& name) const override;
    void consume(const std::string& name, std::size_t count) override;

    /// The state that a socket has as soon as it is opened.
    SocketState first_state = SocketState::open;
    /// Bytes that its peer has sent by then.
    std::string first_received;
    std::map<std::string, Socket> all;
};

/// A robot that a test drives by hand: motions last until the test says so, or so many cycles.
class FakeRobot final : public Robot {
public:
    double stepTime() const override { return step_time; }
    const RobotState& state() const override { return now; }
    Result<Vector6> jointPositionHistory(int cycles) const override;
    Result<void> beginMotion(const Motion& motion) override;
    Result<bool> motionDone() override;
    void abandonMotion() override { ++abandoned; }
    Result<void> apply(const Command& command) override;
    int toolContact(const Vector6& direction) const override;
    Result<Vector6> inverseKinematics(const Pose& base_from_tool, const Vector6& near,
                                      const Pose& flange_from_tool) const override;
    Result<Pose> forwardKinematics(const Vector6& joint_position,
                                   const Pose& flange_from_tool) const override;
    bool withinLimits(const Target& target) const override;
    Pose targetWaypoint() const override { return waypoint; }
    Result<std::int32_t> integerRegister(RegisterBank bank, int index) const override;
    Result<double> floatRegister(RegisterBank bank, int index) const override;
    Result<bool> bitRegister(RegisterBank bank, int index) const override;
    Result<void> writeIntegerRegister(int index, std::int32_t value) override;
    Result<void> writeFloatRegister(int index, double value) override;
    Result<void> writeBitRegister(int index, bool value) override;
    Result<bool> digitalInput(DigitalPort port, int index) const override;
    Result<bool> digitalOutput(DigitalPort port, int index) const override;
    Result<void> setDigitalOutput(DigitalPort port, int index, bool value) override;
    Result<double> analogInput(AnalogPort port, int index) const override;
    Result<double> analogOutput(AnalogPort port, int index) const override;
    Result<void> setAnalogOutput(AnalogPort port, int index, double share) override;
    void textMessage(const std::string& text) override { messages.push_back(text); }
    void showPopup(const Popup& popup) override;
    bool popupOpen() const override { return popup_open; }
    Sockets& sockets() override { return socket; }

    /// The motion that was begun last.
    template <typename T>
    const T& lastMotion() const {
        return std::get<T>(motions.back());
    }
    template <typename T>
    const T& lastCommand() const {
        return std::get<T>(commands.back());
    }

    double step_time = 0.008;
    RobotState now;
    Pose waypoint;
    std::vector<Motion> motions;
    std::vector<Command> commands;
    int motion_cycles = 1;  ///< that a motion lasts
    int abandoned = 0;
    int contact = 0;
    std::string refusal;  ///< error of every motion; empty: no error
    std::array<std::int32_t, 48> input_integers{};
    std::array<double, 48> input_floats{};
    std::array<std::int32_t, 48> output_integers{};
    std::array<double, 48> output_floats{};
    std::map<std::pair<RegisterBank, int>, bool> bits;
    std::map<std::pair<DigitalPort, int>, bool> inputs;
    std::map<std::pair<DigitalPort, int>, bool> outputs;
    std::map<std::pair<AnalogPort, int>, double> analog_inputs;
    std::map<std::pair<AnalogPort, int>, double> analog_outputs;
    std::vector<std::string> messages;
    std::vector<Popup> popups;
    bool popup_open = false;
    FakeSockets socket;

private:
    int cycles_left_ = 0;
};

/// A program that has to be understood; throws if it is not.
Program parsed(std::string_view text);
/// Why a text is no program; empty if it is one.
std::string parseError(std::string_view text);
/// The statements within `def test(): ... end`.
std::string within(std::string_view statements);
/// Runs statements on a robot of its own until they end, at most 1000 cycles; the variable
/// `result` as text, or "line:column text" of the runtime exception.
std::string resultOf(std::string_view statements);
std::string resultOf(std::string_view statements, FakeRobot& robot);

}  // namespace metier::urscript
