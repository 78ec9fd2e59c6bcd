#include "moves/force_report.hpp"

#include <fmt/format.h>

namespace metier::robot_skills {

namespace {

skill::Vector3 toVector3(const Eigen::Vector3d& vector) {
    return {vector.x(), vector.y(), vector.z()};
}

std::string textOf(const skill::Vector3& force) {
    return fmt::format("[{:.1f}, {:.1f}, {:.1f}] N", force.x, force.y, force.z);
}

}  // namespace

void tellForceMove(const skill::ExecutionHandle& tell, const ForceMoveParameters& parameters,
                   const MoveResults& results, const MetForce& met) {
    ForceMoveResults all;
    static_cast<MoveResults&>(all) = results;
    all.contact_force = toVector3(met.contact.force);
    all.contact_torque = toVector3(met.contact.torque);
    all.forces_max = toVector3(met.largest);
    if (met.exceeded) {
        all.forces_exceeded = all.contact_force;
    }
    if (met.exceeded && parameters.halt_on_force) {
        tell.fail(skill::Reason::force_exceeded,
                  fmt::format("the contact force {} in the base frame is over its limit {}",
                              textOf(all.contact_force), textOf(parameters.max_force)));
        return;
    }
    tell.finish(forceMoveResultFields().write(all));
}

}  // namespace metier::robot_skills
