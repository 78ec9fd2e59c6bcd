#pragma once

#include <memory>
#include <vector>

#include "metier/device/gripper.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/field_list.hpp"
#include "metier/skill/resource.hpp"
#include "metier/skill/skill.hpp"

namespace metier::robot_skills {

/// Parameters of a gripper's skills.
struct GripperParameters {
    /// Force to hold a part with [N], 0 to 1000 and within GripperInfo; 0: the gripper's own
    /// default.
    double force = 0.0;
    /// Width [m], 0 to 1 and at most GripperInfo::stroke; 0: not known (grasp), as far as possible
    /// (release), closed (move).
    double width = 0.0;
};

/// Results of a gripper's skills.
struct GripperResults {
    /// Measured distance between the jaws at the end [m].
    double width_reached = 0.0;
    /// Whether they hold a part at the end.
    bool part_held = false;
};

/// Fields WidthReached and PartHeld of those results; lives as long as the program. Any thread.
const skill::FieldList<GripperResults>& gripperResultFields();

/// All skills that a gripper can have. A server publishes those that it wants.
struct GripperSkills {
    /// Put it into the ProgramOptions of every skill of this gripper: they exclude each other.
    std::shared_ptr<skill::Resource> resource;
    /// Grasp-, Release-, MoveGripperSkill.
    std::vector<std::unique_ptr<skill::Skill>> skills;
};

/// Makes the skills of a gripper with jaws.
///
/// Start refuses a force or a width that the gripper cannot do (out_of_range), jaws that still move
/// (invalid_state) and a gripper that is not ready (device_fault). Suspend and Halt stop the jaws,
/// which keep holding a part; Resume asks for the same motion again. A grasp that holds no part at
/// its end is Halted with an error, even if the gripper reports success; so is a release that still
/// holds one. Reset is device::Gripper::resetFault(), and timeout while the jaws still move.
///
/// \param gripper must outlive the skills
GripperSkills makeGripperSkills(device::Gripper& gripper);

/// Makes the HoldGripperSkill. It is Running for as long as the gripper holds a part, and Halted
/// with an error within 20 ms after the gripper's state shows that the part is lost (device_lost if
/// the gripper is lost). It moves nothing, so it needs no resource, and other skills run beside it.
/// It does not end by itself while the part is held: Halt it.
///
/// Start and Resume are refused with device_fault if no part is held, with connection_lost if the
/// gripper is not connected.
/// \param gripper  must outlive the skill
/// \param executor of the thread that owns the skill's Program; it looks at the gripper every 20 ms
std::unique_ptr<skill::Skill> makeHoldSkill(const device::Gripper& gripper,
                                            std::shared_ptr<skill::Executor> executor);

}  // namespace metier::robot_skills
