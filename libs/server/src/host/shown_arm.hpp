#pragma once

#include <memory>

#include "metier/base/clock.hpp"
#include "metier/device/arm.hpp"
#include "metier/device/force_torque_sensor.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"
#include "metier/opcua_skill/live_figures.hpp"
#include "metier/robot_skills/arm_skills.hpp"

namespace metier::server {

/// An arm as a server shows it; arm, model and sensor must outlive the server.
struct ShownArm {
    const device::Arm& arm;
    const motion::RobotModel& model;
    double payload = 0;                                 ///< [kg]; 0: unknown
    const device::ForceTorqueSensor* sensor = nullptr;  ///< sensor at its flange
    /// Shared with the arm's stream skill; null: it has none.
    std::shared_ptr<const robot_skills::StreamReport> stream{};
    /// Shared with its moves; null: it has none of metier's.
    std::shared_ptr<const robot_skills::StoppingReport> stopping{};
};

/// Present position of the arm, and whether it may move. Threads: any; does not wait.
opcua_skill::KinematicsState stateOf(const ShownArm& shown);

/// Functions that read its live figures, each for any thread; none waits.
/// \param clock must outlive them
opcua_skill::ArmFigures figuresOf(const ShownArm& shown, const Clock& clock);

}  // namespace metier::server
