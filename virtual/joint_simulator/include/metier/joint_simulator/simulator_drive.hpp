#pragma once

#include <stop_token>
#include <thread>

#include "metier/device/notifier.hpp"
#include "metier/joint_simulator/joint_simulator.hpp"

namespace metier::joint_simulator {

/// Runs a simulated arm at its real rate: its cycle thread and its notifying thread.
class SimulatorDrive {
public:
    /// Begins at once. The arm must outlive the drive, and nobody else may call cycle(),
    /// dispatch() or step().
    explicit SimulatorDrive(JointSimulator& arm);

    /// Ends both threads within one period; the arm keeps its last state.
    ~SimulatorDrive() = default;
    SimulatorDrive(const SimulatorDrive&) = delete;
    SimulatorDrive& operator=(const SimulatorDrive&) = delete;

private:
    void run(const std::stop_token& stop);

    JointSimulator& arm_;
    device::Notifier notifier_;
    std::jthread cycle_thread_;
};

}  // namespace metier::joint_simulator
