#include "metier/joint_simulator/simulator_drive.hpp"

#include "metier/joint_simulator/time_base.hpp"

namespace metier::joint_simulator {

SimulatorDrive::SimulatorDrive(JointSimulator& arm)
    : arm_(arm),
      notifier_([this] { arm_.dispatch(); }),
      cycle_thread_([this](const std::stop_token& stop) { run(stop); }) {}

void SimulatorDrive::run(const std::stop_token& stop) {
    const auto period = arm_.info().cycle;
    TimeBase time_base(std::chrono::steady_clock::now() + period, period);
    while (!stop.stop_requested()) {
        std::this_thread::sleep_until(time_base.next());
        const auto now = std::chrono::steady_clock::now();
        const auto due = time_base.begin(now);
        arm_.measure(now - due);
        if (arm_.cycle(due, time_base.missed())) {
            notifier_.signal();
        }
    }
}

}  // namespace metier::joint_simulator
