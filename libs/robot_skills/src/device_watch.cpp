#include "metier/robot_skills/device_watch.hpp"

#include <string>
#include <utility>

namespace metier::robot_skills {

namespace {

void tellLost(const std::vector<skill::Program*>& programs, const std::string& text) {
    for (auto* program : programs) {
        program->deviceLost(text);
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
    registration_ =
        device.onSafetyChange([executor = std::move(executor),
                               watched = std::weak_ptr(programs_)](const device::Safety& safety) {
            if (safety.state != device::SafetyState::disconnected) {
                return;
            }
            executor->post([watched, text = safety.text] {
                if (const auto alive = watched.lock()) {
                    tellLost(*alive, text);
                }
            });
        });
}

}  // namespace metier::robot_skills
