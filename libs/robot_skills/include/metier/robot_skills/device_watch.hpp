#pragma once

#include <memory>
#include <vector>

#include "metier/device/arm.hpp"
#include "metier/device/gripper.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/program.hpp"

namespace metier::robot_skills {

/// Tells all Programs of an arm or a gripper when it is gone: each is Halted, also from Ready. When
/// its controller is in a stop or a fault, those that are Ready are Halted, too: Reset is the way
/// back. Both also at once, if it is so already.
///
/// Threading: made and destroyed on the owner's thread.
class DeviceWatch {
public:
    /// \param arm      must outlive this
    /// \param executor of the owner's thread; shared, since it is posted to from the device's
    /// \param programs must outlive this
    DeviceWatch(device::Arm& arm, std::shared_ptr<skill::Executor> executor,
                std::vector<skill::Program*> programs);
    /// The same for a gripper.
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
