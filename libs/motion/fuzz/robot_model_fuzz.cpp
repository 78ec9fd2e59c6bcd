// Takes any text for a robot model's file; a model that is accepted can be used.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "metier/motion/robot_model.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace metier::motion;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto model = RobotModel::parse(text, "model.toml");
    if (!model) {
        if (model.error().message.empty()) {
            std::abort();
        }
        return 0;
    }
    if (!model->kinematics().withinLimits(model->home()) || !(model->cycleTime() > 0.0)) {
        std::abort();
    }
    const auto flange = model->kinematics().forward(model->home());
    if (!(std::abs(flange.rotation.norm() - 1.0) < 1e-6)) {
        std::abort();
    }
    for (const auto& capsule : model->capsules()) {
        if (capsule.link > model->axisCount()) {
            std::abort();
        }
    }
    static_cast<void>(model->tool("t"));
    return 0;
}
