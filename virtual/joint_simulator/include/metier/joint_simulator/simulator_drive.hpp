#pragma once

#include <stop_token>
#include <thread>

#include "metier/device/notifier.hpp"
#include "metier/joint_simulator/joint_simulator.hpp"

namespace metier::joint_simulator {

/// Cycle thread and notifying thread of a simulated arm; runs it at its real rate. Its destructor
/// ends both within one period; the arm keeps its last state.
///
/// Threading: one thread creates and destroys it. It starts two threads of its own: one calls
///            cycle(), the other dispatch().
///
///     auto arm = JointSimulator::create(optionsFor(model));
///     SimulatorDrive drive(**arm);  // from now on the arm moves in real time
class SimulatorDrive {
public:
    /// Begins at once. The arm must outlive the drive; no other code may call its cycle(),
    /// dispatch() or step() meanwhile.
    explicit SimulatorDrive(JointSimulator& arm);

private:
    void run(const std::stop_token& stop);

    JointSimulator& arm_;
    device::Notifier notifier_;
    std::jthread cycle_thread_;
};

}  // namespace metier::joint_simulator
