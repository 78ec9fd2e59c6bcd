#include "metier/robot_skills/arm_skills.hpp"

#include <fmt/format.h>

#include <utility>

#include "moves/move_skills.hpp"

namespace metier::robot_skills {

Result<ArmSkills> makeArmSkills(const ArmDevices& devices, const motion::RobotModel& model,
                                const Clock& clock, const PositionStreamOptions& stream) {
    const auto& info = devices.arm.info();
    if (info.axisCount() != model.axisCount()) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} has {} axes, the model {} has {}", info.name, info.axisCount(),
                                model.name(), model.axisCount()));
    }
    const MovedArm arm{devices, model, clock};
    return ArmSkills{std::make_shared<skill::Resource>("arm " + info.name), makeMoveSkills(arm),
                     makePositionStreamSkill(devices.arm, model, clock, stream), stream.report,
                     arm.stopping};
}

}  // namespace metier::robot_skills
