#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "metier/base/error.hpp"
#include "metier/urscript/command.hpp"
#include "metier/urscript/motion.hpp"
#include "metier/urscript/value.hpp"

namespace metier::urscript {

/// State of the arm that scripts can read. SI units and radians; poses and wrench in the base
/// frame.
struct RobotState {
    /// Measured joint position, axis 1 first [rad].
    Vector6 actual_joint_position{};
    /// Commanded joint position [rad].
    Vector6 target_joint_position{};
    /// Measured joint velocity [rad/s].
    Vector6 actual_joint_velocity{};
    /// Commanded joint velocity [rad/s].
    Vector6 target_joint_velocity{};
    /// Torque of each joint [N m].
    Vector6 joint_torque{};
    /// Temperature of each joint [degree Celsius].
    Vector6 joint_temperature{};
    /// Measured pose of the tool frame, base_from_tool.
    Pose actual_tool_pose;
    /// Commanded pose of the tool frame, base_from_tool.
    Pose target_tool_pose;
    /// Measured twist of the tool frame [m/s], [rad/s].
    Vector6 actual_twist{};
    /// Commanded twist of the tool frame [m/s], [rad/s].
    Vector6 target_twist{};
    /// Wrench at the tool [N], [N m].
    Vector6 wrench{};
    /// Value of the last set_tcp.
    Pose flange_from_tool;
    /// Mass of the load [kg].
    double payload_mass = 0.0;
    /// Centre of gravity of the load in the flange frame [m].
    Vector3 payload_cog{};
    /// Ixx, Iyy, Izz, Ixy, Ixz, Iyz of the load [kg m^2].
    Vector6 payload_inertia{};
    /// Time of the controller [s]; counted in cycles, never read from a clock.
    double time = 0.0;
    /// Whether the arm stands still.
    bool steady = true;
};

/// Registers that RTDE clients write (input), or that scripts write (output).
enum class RegisterBank { input, output };
/// Connectors with digital inputs and outputs.
enum class DigitalPort { standard, configurable, tool };
/// Connectors with analogue inputs and outputs.
enum class AnalogPort { standard, tool };
/// State of a script's socket.
enum class SocketState {
    /// Never opened, closed by either side, or failed to open.
    closed,
    /// Connects; the script waits or goes on.
    opening,
    /// Connected.
    open,
};

/// Sockets that scripts open; each has a name given by the script. No function here waits.
class Sockets {
public:
    virtual ~Sockets() = default;

    /// Begins to connect. An existing socket of that name is closed first.
    /// \param host a name or an address
    /// \param port TCP port of the peer
    virtual void open(const std::string& name, const std::string& host, int port) = 0;
    /// Present state; closed for an unknown name.
    virtual SocketState state(const std::string& name) const = 0;
    /// Closes the socket; nothing happens for an unknown name.
    virtual void close(const std::string& name) = 0;
    /// \return false if the socket is not open, or takes no more
    virtual bool send(const std::string& name, std::string_view bytes) = 0;
    /// Received bytes that were not consumed, oldest first; also after the peer has closed. The
    /// view is valid until the next call of any function here.
    virtual std::string_view received(const std::string& name) const = 0;
    /// Drops the first `count` bytes of received(); `count` is at most their number.
    virtual void consume(const std::string& name, std::size_t count) = 0;
};

/// A message that a script shows on the panel.
struct Popup {
    /// Kind of the message.
    enum class Level { message, warning, error };
    /// Text and heading.
    std::string text;
    /// Heading of the message.
    std::string title;
    /// Kind of the message.
    Level level = Level::message;
    /// Whether the calling thread waits until popupOpen() is false.
    bool blocking = false;
};

/// Interface of a controller for scripts. Implemented by the virtual controller, and by hand in
/// tests.
///
/// An Error that a function returns ends the program with a runtime exception of that message.
/// Threading: the thread that calls Interpreter::step(). Nothing here waits.
class Robot {
public:
    virtual ~Robot() = default;

    /// Length of one cycle [s], > 0.
    virtual double stepTime() const = 0;
    /// State of the arm in this cycle.
    virtual const RobotState& state() const = 0;
    /// Joint position `cycles` cycles ago [rad]; 0 is now.
    /// \param cycles >= 0; how far back is the robot's choice, beyond it an Error
    virtual Result<Vector6> jointPositionHistory(int cycles) const = 0;

    /// Begins a motion. It replaces the motion before, which may still be running (a script may
    /// stop a moving arm).
    /// Errors: the motion is impossible, such as a pose out of reach.
    virtual Result<void> beginMotion(const Motion& motion) = 0;
    /// Reports whether the motion that was begun last is done; called once per cycle, for the first
    /// time in the cycle after its begin. Errors: the motion is impossible (protective stop, ...).
    virtual Result<bool> motionDone() = 0;
    /// Abandons the motion, because the thread that began it was killed or the program ended.
    /// Brakes the arm unless a motion is begun within the same cycle.
    virtual void abandonMotion() = 0;

    /// Performs a command at once.
    virtual Result<void> apply(const Command& command) = 0;
    /// Number of cycles since the tool came into contact in `direction`; 0: no contact.
    /// \param direction velocity towards the expected contact [m/s], [rad/s]; all 0: any direction
    virtual int toolContact(const Vector6& direction) const = 0;

    /// Joint position for a pose of the tool frame [rad].
    /// \param near joint position; the solution closest to it is taken [rad]
    /// Errors: no solution.
    virtual Result<Vector6> inverseKinematics(const Pose& base_from_tool, const Vector6& near,
                                              const Pose& flange_from_tool) const = 0;
    /// base_from_tool for a joint position [rad].
    virtual Result<Pose> forwardKinematics(const Vector6& joint_position,
                                           const Pose& flange_from_tool) const = 0;
    /// Reports whether the arm may be there: every axis within its limits, or a pose that is
    /// reached by such axes.
    virtual bool withinLimits(const Target& target) const = 0;
    /// End pose of the running move, or the commanded tool pose if no move runs.
    virtual Pose targetWaypoint() const = 0;

    // Registers, counted from 0 in each bank. Errors: out_of_range if there is no such register.
    /// Whole number of a register.
    virtual Result<std::int32_t> integerRegister(RegisterBank bank, int index) const = 0;
    /// Number of a register.
    virtual Result<double> floatRegister(RegisterBank bank, int index) const = 0;
    /// Bit of a register.
    virtual Result<bool> bitRegister(RegisterBank bank, int index) const = 0;
    /// Writes an output register, as do the next two.
    virtual Result<void> writeIntegerRegister(int index, std::int32_t value) = 0;
    virtual Result<void> writeFloatRegister(int index, double value) = 0;
    virtual Result<void> writeBitRegister(int index, bool value) = 0;

    // Inputs and outputs, counted from 0 in each port. Errors: out_of_range.
    /// Level that an input has.
    virtual Result<bool> digitalInput(DigitalPort port, int index) const = 0;
    /// Level that an output has.
    virtual Result<bool> digitalOutput(DigitalPort port, int index) const = 0;
    /// Sets the level of an output.
    virtual Result<void> setDigitalOutput(DigitalPort port, int index, bool value) = 0;
    /// Value of an input [V] or [A], as its domain says.
    virtual Result<double> analogInput(AnalogPort port, int index) const = 0;
    /// Value of an output as a share of its range, 0 to 1.
    virtual Result<double> analogOutput(AnalogPort port, int index) const = 0;
    /// Sets an output to a share of its range, 0 to 1.
    virtual Result<void> setAnalogOutput(AnalogPort port, int index, double share) = 0;

    /// Writes to the log, and sends a text message to primary clients.
    virtual void textMessage(const std::string& text) = 0;
    /// Shows a message; popupOpen() reports it from then on.
    virtual void showPopup(const Popup& popup) = 0;
    /// Whether a message is open.
    virtual bool popupOpen() const = 0;

    /// Sockets of the scripts; valid as long as the robot.
    virtual Sockets& sockets() = 0;
};

}  // namespace metier::urscript
