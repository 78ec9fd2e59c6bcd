#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "axes.hpp"
#include "codes.hpp"
#include "metier/joint_simulator/lag.hpp"

namespace metier::virtual_edo {

/// Report of one joint.
struct JointReport {
    double position = 0.0;  ///< [deg], the gripper [mm]
    double velocity = 0.0;  ///< per second
    double current = 0.0;   ///< [A]
    std::uint16_t flags = 0;

    bool has(JointFlag flag) const { return ((flags >> static_cast<unsigned>(flag)) & 1U) != 0; }
};

/// Reports of all joints in one cycle.
struct BusReport {
    std::uint64_t mask = 0;  ///< joints that have reported
    std::vector<JointReport> joints;
};

/// The joints and their bus: they follow targets, brake, and acknowledge commands by a pulse in
/// their flags, some time after the command.
///
/// Threading: one thread.
/// Source: Comau/eDO_core, src/edo_usb_fake_node.cpp; latencies as seen with its state machine.
class JointBus {
public:
    /// \param axes     that there are, 6 or 7
    /// \param position at the start
    JointBus(const AxisLimits& limits, std::size_t axes, const AxisValues& position);

    // Commands; each is done after the bus's latency and acknowledged by the joints of the mask.
    void discover(std::uint64_t mask);
    void reset(std::uint64_t mask) { enqueue(Acknowledge::reset, mask); }
    void calibrate(std::uint64_t mask) { enqueue(Acknowledge::calibration, mask); }
    void configure(std::uint64_t mask) { enqueue(Acknowledge::configuration, mask); }
    /// A command that changes nothing here but is acknowledged.
    void touch(std::uint64_t mask) { enqueue(Acknowledge::init, mask); }

    /// New target of every configured axis. An array of another length is ignored.
    void command(const std::vector<double>& position);
    /// Opens the power stages: the brakes hold every axis where it is.
    void brake();
    /// Makes the joints known, calibrated and free at once, as after a start-up that went well.
    void makeReady();

    /// One cycle.
    /// \param part_width between the jaws [mm], if there is a part
    void step(std::optional<double> part_width);

    /// Nothing while the bus is silent.
    std::optional<BusReport> report() const;

    /// Reports whether the last step() set the zero of some axis.
    bool justCalibrated() const { return just_calibrated_; }
    /// True position of the axes, independent of the calibration.
    AxisValues truePosition() const;
    bool grips() const { return grips_; }
    bool isBraked() const;

    // Accidents.
    void setFlag(std::size_t axis, JointFlag flag);
    enum class Bus : std::uint8_t { speaking, silent };
    /// \param mask of the joints that no longer report
    /// \param bus  whether anything is reported at all
    void silence(std::uint64_t mask, Bus bus) {
        silent_ = mask;
        bus_silent_ = bus == Bus::silent;
    }
    /// While it is pressed no power stage closes.
    void pressEmergencyStop();
    void releaseEmergencyStop() { emergency_stop_ = false; }
    bool emergencyStop() const { return emergency_stop_; }

private:
    struct Command {
        Acknowledge kind = Acknowledge::nothing;
        std::uint64_t mask = 0;
        int due = 0;  // cycles until it is done
    };

    void enqueue(Acknowledge kind, std::uint64_t mask);
    void perform(const Command& command);
    void connect(std::uint64_t mask);
    void follow(std::size_t axis, double target, std::optional<double> part_width);
    double stopAtPart(double position, double next, std::optional<double> part_width);
    void check(std::size_t axis, double target);
    void hold();

    AxisLimits limits_;
    std::size_t axes_;
    AxisValues position_;
    AxisValues offset_{};  // true position less position
    AxisValues target_;
    joint_simulator::Lag lag_;
    std::vector<JointReport> joints_;  // configured ones
    std::deque<Command> commands_;
    int pulse_left_ = 0;
    std::uint64_t silent_ = 0;
    bool bus_silent_ = false;
    bool emergency_stop_ = false;
    bool grips_ = false;
    bool just_calibrated_ = false;
};

}  // namespace metier::virtual_edo
