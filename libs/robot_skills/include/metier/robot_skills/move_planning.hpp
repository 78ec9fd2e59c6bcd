#pragma once

#include "metier/motion/planner.hpp"
#include "metier/robot_skills/move_parameters.hpp"

namespace metier::robot_skills {

// The plan of each move skill: what Start calls, for whoever asks before. The parameters are those
// that cartesianMoveFields() and jointMoveFields() have checked; `start` is where the arm stands
// [rad]. Errors: a Refusal, whose error is the answer of Start. Threads: any; pure; allocates.

motion::Planned<motion::Trajectory> planCartesianPtp(const motion::RobotModel& model,
                                                     const motion::JointVector& start,
                                                     const CartesianMoveParameters& parameters);
motion::Planned<motion::Trajectory> planCartesianLinear(const motion::RobotModel& model,
                                                        const motion::JointVector& start,
                                                        const CartesianMoveParameters& parameters);
motion::Planned<motion::Trajectory> planCartesianPath(const motion::RobotModel& model,
                                                      const motion::JointVector& start,
                                                      const PathMoveParameters& parameters);
motion::Planned<motion::Trajectory> planJointPtp(const motion::RobotModel& model,
                                                 const motion::JointVector& start,
                                                 const JointMoveParameters& parameters);
motion::Planned<motion::Trajectory> planJointLinear(const motion::RobotModel& model,
                                                    const motion::JointVector& start,
                                                    const JointMoveParameters& parameters);

/// What planCartesianLinear() asks of the planner.
motion::LinRequest linRequest(const motion::JointVector& start,
                              const CartesianMoveParameters& parameters);

}  // namespace metier::robot_skills
