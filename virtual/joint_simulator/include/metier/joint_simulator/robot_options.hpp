#pragma once

#include "metier/joint_simulator/joint_simulator.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::joint_simulator {

/// A simulated arm of that kind, standing at its home position at its controller's rate.
///
/// The model's accelerations are those to plan with; the simulated drives give twice as much, since
/// a Halt brakes twice as hard as a motion is planned. Only numbers are taken from the model: the
/// guard that judges the set-points is the simulator's own.
JointSimulatorOptions optionsFor(const motion::RobotModel& model);

}  // namespace metier::joint_simulator
