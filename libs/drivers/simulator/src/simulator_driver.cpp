// An arm in this process, without a controller and its wire: for planning a cell, and for tests of
// everything that is above a driver.
#include <utility>

#include "metier/device/driver.hpp"
#include "metier/joint_simulator/joint_simulator.hpp"
#include "metier/joint_simulator/robot_options.hpp"
#include "metier/joint_simulator/simulator_drive.hpp"

namespace metier::simulator_driver {
namespace {

struct SimulatedArm {
    explicit SimulatedArm(std::unique_ptr<joint_simulator::JointSimulator> simulator)
        : arm(std::move(simulator)), drive(*arm) {}

    std::unique_ptr<joint_simulator::JointSimulator> arm;
    joint_simulator::SimulatorDrive drive;
};

Result<device::OpenDevice> open(const device::OpenRequest& request) {
    METIER_TRY(request.settings.finish());
    if (request.model == nullptr) {
        return fail(Errc::invalid_argument, request.name + ": the simulator is one of arms only");
    }
    auto options = joint_simulator::optionsFor(*request.model);
    options.name = request.name;
    METIER_ASSIGN(auto arm, joint_simulator::JointSimulator::create(std::move(options)));
    auto owner = std::make_shared<SimulatedArm>(std::move(arm));
    device::OpenDevice device;
    device.arm = owner->arm.get();
    device.owner = std::move(owner);
    return device;
}

}  // namespace
}  // namespace metier::simulator_driver

namespace metier::device {

Driver simulatorDriver() {
    return {"simulator", "An arm in the server's own process: no controller, no wire",
            simulator_driver::open};
}

}  // namespace metier::device
