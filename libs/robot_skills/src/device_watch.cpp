#include "metier/robot_skills/device_watch.hpp"

#include <utility>

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

DeviceWatch::DeviceWatch(device::Arm& arm, std::shared_ptr<skill::Executor> executor,
                         std::vector<skill::Program*> programs)
    : programs_(std::make_shared<const Programs>(std::move(programs))) {
    watch(arm, std::move(executor));
}

DeviceWatch::DeviceWatch(device::Gripper& gripper, std::shared_ptr<skill::Executor> executor,
                         std::vector<skill::Program*> programs)
    : programs_(std::make_shared<const Programs>(std::move(programs))) {
    watch(gripper, std::move(executor));
}

template <typename Device>
void DeviceWatch::watch(Device& device, std::shared_ptr<skill::Executor> executor) {
    const auto notice = [executor = std::move(executor),
                         watched = std::weak_ptr(programs_)](const device::Safety& safety) {
        executor->post([watched, safety] {
            if (const auto alive = watched.lock()) {
                pass(*alive, safety);
            }
        });
    };
    registration_ = device.onSafetyChange(notice);
    if (const auto now = device.safety(); now.state != device::SafetyState::normal) {
        pass(*programs_, now);
    }
}

}  // namespace metier::robot_skills
