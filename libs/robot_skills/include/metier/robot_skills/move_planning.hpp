#pragma once

#include "metier/motion/planner.hpp"
#include "metier/robot_skills/move_parameters.hpp"

namespace metier::robot_skills {

// Plans of the move skills, exactly as Start makes them, for callers that want to know before. The
// parameters must have passed cartesianMoveFields() or jointMoveFields(); `start` is the present
// joint position [rad].
// Errors: a Refusal; its error is the answer of Start.
// Threads: any; pure; allocates.

/// Plan of CartesianPtpMoveSkill: straight in joint space to a pose.
motion::Planned<motion::Trajectory> planCartesianPtp(const motion::RobotModel& model,
                                                     const motion::JointVector& start,
                                                     const CartesianMoveParameters& parameters);
/// Plan of CartesianLinearMoveSkill: a straight line of the tool frame.
motion::Planned<motion::Trajectory> planCartesianLinear(const motion::RobotModel& model,
                                                        const motion::JointVector& start,
                                                        const CartesianMoveParameters& parameters);
/// Plan of CartesianPathMoveSkill: lines through several poses.
motion::Planned<motion::Trajectory> planCartesianPath(const motion::RobotModel& model,
                                                      const motion::JointVector& start,
                                                      const PathMoveParameters& parameters);
/// Plan of JointPtpMoveSkill: straight in joint space to a joint position.
motion::Planned<motion::Trajectory> planJointPtp(const motion::RobotModel& model,
                                                 const motion::JointVector& start,
                                                 const JointMoveParameters& parameters);
/// Plan of JointLinearMoveSkill: a straight line to the pose of a joint position.
motion::Planned<motion::Trajectory> planJointLinear(const motion::RobotModel& model,
                                                    const motion::JointVector& start,
                                                    const JointMoveParameters& parameters);

/// Request that planCartesianLinear() makes to the planner, without Duration.
/// The units are those of motion::LinRequest: m, rad, s.
motion::LinRequest linRequest(const motion::JointVector& start,
                              const CartesianMoveParameters& parameters);

}  // namespace metier::robot_skills
