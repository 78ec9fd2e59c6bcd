#include <memory>
#include <utility>

#include "edo_arm.hpp"
#include "metier/device/driver.hpp"

namespace metier::device {

Driver edoDriver();

namespace {

struct Edo {
    explicit Edo(edo_driver::EdoOptions options) : arm(std::move(options)), gripper(arm) {}

    edo_driver::EdoArm arm;
    edo_driver::EdoGripper gripper;
};

Result<OpenDevice> open(const OpenRequest& request) {
    METIER_ASSIGN(auto options, edo_driver::readOptions(request));
    const bool has_gripper = options.layout.gripper;
    auto edo = std::make_shared<Edo>(std::move(options));
    OpenDevice device;
    device.arm = &edo->arm;
    device.gripper = has_gripper ? &edo->gripper : nullptr;
    device.owner = std::move(edo);
    return device;
}

}  // namespace

Driver edoDriver() {
    return {"edo",
            "Comau e.DO with its gripper, by rosbridge (software up to 3.0.1, and 3.1.2 on)",
            open,
            {"port", 9090}};
}

}  // namespace metier::device
