#include "metier/joint_simulator/robot_options.hpp"

#include <chrono>

namespace metier::joint_simulator {

JointSimulatorOptions optionsFor(const motion::RobotModel& model) {
    constexpr double drive_reserve = 2.0;
    JointSimulatorOptions options;
    options.name = model.name();
    options.cycle = std::chrono::round<std::chrono::nanoseconds>(
        std::chrono::duration<double>(model.cycleTime()));
    options.start_position.assign(model.home().begin(), model.home().end());
    for (const auto& joint : model.chain().joints) {
        options.axis_names.push_back(joint.name);
        options.limits.push_back({joint.limits.lower, joint.limits.upper, joint.limits.velocity,
                                  drive_reserve * joint.limits.acceleration});
    }
    return options;
}

}  // namespace metier::joint_simulator
