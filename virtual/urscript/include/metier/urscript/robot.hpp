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
    Vector6 actual_joint_position{};
    Vector6 target_joint_position{};
    Vector6 actual_joint_velocity{};
    Vector6 target_joint_velocity{};
    Vector6 joint_torque{};
    Vector6 joint_temperature{};  ///< [degree Celsius]
    Pose actual_tool_pose;
    Pose target_tool_pose;
    Vector6 actual_twist{};
    Vector6 target_twist{};
    Vector6 wrench{};           ///< at the tool
    Pose flange_from_tool;      ///< value of the last set_tcp
    double payload_mass = 0.0;  ///< [kg]
    Vector3 payload_cog{};      ///< [m]
    Vector6 payload_inertia{};  ///< Ixx, Iyy, Izz, Ixy, Ixz, Iyz [kg m^2]
    double time = 0.0;          ///< time of the controller [s]; counted in cycles, never read from
                                ///< a clock
    bool steady = true;         ///< the arm stands still
};

enum class RegisterBank { input, output };
enum class DigitalPort { standard, configurable, tool };
enum class AnalogPort { standard, tool };
enum class SocketState {
    closed,  ///< never opened, closed by either side, or failed to open
    opening,
    open,
};

/// Sockets that scripts open; each has a name given by the script. No function here waits.
class Sockets {
public:
    virtual ~Sockets() = default;

    /// Begins to connect. An existing socket of that name is closed first.
    virtual void open(const std::string& name, const std::string& host, int port) = 0;
    virtual SocketState state(const std::string& name) const = 0;
    virtual void close(const std::string& name) = 0;
    /// \return false if the socket is not open, or takes no more
    virtual bool send(const std::string& name, std::string_view bytes) = 0;
    /// Received bytes that were not consumed, oldest first; also after the peer has closed. The
    /// view is valid until the next call of any function here.
    virtual std::string_view received(const std::string& name) const = 0;
    /// Drops the first `count` bytes of received(); `count` is at most their number.
    virtual void consume(const std::string& name, std::size_t count) = 0;
};

struct Popup {
    enum class Level { message, warning, error };
    std::string text;
    std::string title;
    Level level = Level::message;
    bool blocking = false;  ///< the calling thread waits until popupOpen() is false
};

/// Interface of a controller for scripts. Implemented by the virtual controller, and by hand in
/// tests.
///
/// An Error that a function returns ends the program with a runtime exception of that message.
/// Threading: the thread that calls Interpreter::step(). Nothing here waits.
class Robot {
public:
    virtual ~Robot() = default;

    virtual double stepTime() const = 0;  ///< one cycle [s]
    /// State of the arm in this cycle.
    virtual const RobotState& state() const = 0;
    /// Joint position `cycles` cycles ago [rad]; 0 is now.
    virtual Result<Vector6> jointPositionHistory(int cycles) const = 0;

    /// Begins a motion. It replaces the motion before, which may still be running (a script may
    /// stop a moving arm).
    virtual Result<void> beginMotion(const Motion& motion) = 0;
    /// Reports whether the motion that was begun last is done; called once per cycle, for the first
    /// time in the cycle after its begin. Errors: the motion is impossible (protective stop, ...).
    virtual Result<bool> motionDone() = 0;
    /// Abandons the motion, because the thread that began it was killed or the program ended.
    /// Brakes the arm unless a motion is begun within the same cycle.
    virtual void abandonMotion() = 0;

    virtual Result<void> apply(const Command& command) = 0;
    /// Number of cycles since the tool came into contact in `direction`; 0: no contact.
    /// \param direction velocity towards the expected contact [m/s], [rad/s]; all 0: any direction
    virtual int toolContact(const Vector6& direction) const = 0;

    /// \param near joint position; the solution closest to it is taken [rad]
    virtual Result<Vector6> inverseKinematics(const Pose& base_from_tool, const Vector6& near,
                                              const Pose& flange_from_tool) const = 0;
    virtual Result<Pose> forwardKinematics(const Vector6& joint_position,
                                           const Pose& flange_from_tool) const = 0;
    /// Reports whether the arm may be there: every axis within its limits, or a pose that is
    /// reached by such axes.
    virtual bool withinLimits(const Target& target) const = 0;
    /// End pose of the running move, or the commanded tool pose if no move runs.
    virtual Pose targetWaypoint() const = 0;

    // Registers. Errors: out_of_range if there is no such register.
    virtual Result<std::int32_t> integerRegister(RegisterBank bank, int index) const = 0;
    virtual Result<double> floatRegister(RegisterBank bank, int index) const = 0;
    virtual Result<bool> bitRegister(RegisterBank bank, int index) const = 0;
    virtual Result<void> writeIntegerRegister(int index, std::int32_t value) = 0;
    virtual Result<void> writeFloatRegister(int index, double value) = 0;
    virtual Result<void> writeBitRegister(int index, bool value) = 0;

    // Inputs and outputs, counted from 0 in each port. Errors: out_of_range.
    virtual Result<bool> digitalInput(DigitalPort port, int index) const = 0;
    virtual Result<bool> digitalOutput(DigitalPort port, int index) const = 0;
    virtual Result<void> setDigitalOutput(DigitalPort port, int index, bool value) = 0;
    virtual Result<double> analogInput(AnalogPort port, int index) const = 0;   ///< [V] or [A]
    virtual Result<double> analogOutput(AnalogPort port, int index) const = 0;  ///< share, 0 to 1
    virtual Result<void> setAnalogOutput(AnalogPort port, int index, double share) = 0;

    /// Writes to the log, and sends a text message to primary clients.
    virtual void textMessage(const std::string& text) = 0;
    virtual void showPopup(const Popup& popup) = 0;
    virtual bool popupOpen() const = 0;

    virtual Sockets& sockets() = 0;
};

}  // namespace metier::urscript
