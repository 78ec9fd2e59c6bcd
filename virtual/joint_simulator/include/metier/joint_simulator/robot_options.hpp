#pragma once

#include "metier/joint_simulator/joint_simulator.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::joint_simulator {

/// Options of a simulated arm of this model: it stands at its home position and has its
/// controller's cycle.
///
/// Motions are planned with the model's accelerations; the simulated drives allow twice as much,
/// since a Halt brakes twice as hard. Only numbers are taken from the model: the guard that checks
/// the set-points is the simulator's own. Threads: any; pure.
JointSimulatorOptions optionsFor(const motion::RobotModel& model);

}  // namespace metier::joint_simulator
