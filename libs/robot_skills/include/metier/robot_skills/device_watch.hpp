#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "metier/device/arm.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/program.hpp"

namespace metier::robot_skills {

/// Halts the Programs of an arm or a gripper when the device cannot be used. When the device is
/// lost, all are Halted, also from Ready. When its controller is in a stop or a fault, those that
/// are Ready are Halted, too; Reset leads back. Both also happen at once if the device is in such a
/// state already.
///
/// Threading: made and destroyed on the owner's thread. The device's thread only posts to that one.
class DeviceWatch {
public:
    /// \param device   a device::Arm or device::Gripper, must outlive this
    /// \param executor of the owner's thread; shared, since the device's thread posts to it
    /// \param programs must outlive this
    template <typename Device>
    DeviceWatch(Device& device, std::shared_ptr<skill::Executor> executor,
                std::vector<skill::Program*> programs)
        : programs_(std::make_shared<const Programs>(std::move(programs))),
          registration_(device.onSafetyChange(notice(std::move(executor)))) {
        begin(device.safety());
    }

private:
    using Programs = std::vector<skill::Program*>;

    /// Makes the callback of the device's thread.
    device::Arm::SafetyCallback notice(std::shared_ptr<skill::Executor> executor) const;
    /// Acts on the state that the device has at the start.
    void begin(const device::Safety& now) const;

    // Shared with what was posted and has not run yet: it may find them gone.
    std::shared_ptr<const Programs> programs_;
    device::Registration registration_;
};

}  // namespace metier::robot_skills
