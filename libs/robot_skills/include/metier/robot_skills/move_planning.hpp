#pragma once

#include "metier/motion/planner.hpp"
#include "metier/robot_skills/move_parameters.hpp"

namespace metier::robot_skills {

// Plans of the move skills, exactly as Start makes them, for callers that want to know before. The
// parameters must have passed cartesianMoveFields() or jointMoveFields(); `start` is the present
// joint position [rad].
// Errors: a Refusal; its error is the answer of Start.
// Threads: any; pure; allocates.

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

/// Request that planCartesianLinear() makes to the planner.
motion::LinRequest linRequest(const motion::JointVector& start,
                              const CartesianMoveParameters& parameters);

}  // namespace metier::robot_skills
