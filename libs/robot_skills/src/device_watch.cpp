#include "metier/robot_skills/device_watch.hpp"

namespace metier::robot_skills {

namespace {

void pass(const std::vector<skill::Program*>& programs, const device::Safety& safety) {
    for (auto* program : programs) {
        switch (safety.state) {
            case device::SafetyState::normal:
                program->deviceReady();
                break;
            case device::SafetyState::disconnected:
                program->deviceLost(safety.text);
                break;
            default:
                program->deviceNotReady(safety.text);
                break;
        }
    }
}

}  // namespace

device::Arm::SafetyCallback DeviceWatch::notice(std::shared_ptr<skill::Executor> executor) const {
    return [executor = std::move(executor),
            watched = std::weak_ptr(programs_)](const device::Safety& safety) {
        executor->post([watched, safety] {
            if (const auto alive = watched.lock()) {
                pass(*alive, safety);
            }
        });
    };
}

void DeviceWatch::begin(const device::Safety& now) const {
    if (now.state != device::SafetyState::normal) {
        pass(*programs_, now);
    }
}

}  // namespace metier::robot_skills
