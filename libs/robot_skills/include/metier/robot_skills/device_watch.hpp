#pragma once

#include <memory>
#include <vector>

#include "metier/device/arm.hpp"
#include "metier/device/gripper.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/program.hpp"

namespace metier::robot_skills {

/// Halts the Programs of an arm or a gripper when the device cannot be used. When the device is
/// lost, all are Halted, also from Ready. When its controller is in a stop or a fault, those that
/// are Ready are Halted, too; Reset leads back. Both also happen at once if the device is in such a
/// state already.
///
/// Threading: made and destroyed on the owner's thread.
class DeviceWatch {
public:
    /// \param arm      must outlive this
    /// \param executor of the owner's thread; shared, since the device's thread posts to it
    /// \param programs must outlive this
    DeviceWatch(device::Arm& arm, std::shared_ptr<skill::Executor> executor,
                std::vector<skill::Program*> programs);
    /// Watches a gripper in the same way.
    DeviceWatch(device::Gripper& gripper, std::shared_ptr<skill::Executor> executor,
                std::vector<skill::Program*> programs);

private:
    using Programs = std::vector<skill::Program*>;

    template <typename Device>
    void watch(Device& device, std::shared_ptr<skill::Executor> executor);

    // Shared with what was posted and has not run yet: it may find them gone.
    std::shared_ptr<const Programs> programs_;
    device::Registration registration_;
};

}  // namespace metier::robot_skills
