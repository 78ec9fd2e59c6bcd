#pragma once

#include <optional>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::robot_files {

/// A file as it was read.
struct SourceFile {
    /// Stands for the file in messages, and gives the commands in them.
    std::string name;
    std::string text;
};

/// Choices for a file, and values that count where the file gives none.
struct ImportOptions {
    /// Link whose frame becomes the base frame; empty: the only link without a parent.
    std::string base;
    /// Link whose frame becomes the flange; empty: found as docs/guide/robot-files.md describes.
    std::string tip;
    /// Group of the SRDF file that gives base and tip; empty: its only group that is a chain.
    std::string group;
    /// Name of the model; empty: the robot's name in the file.
    std::string name;
    std::string maker;
    std::string product;
    /// Period of the controller [s], > 0.
    std::optional<double> cycle_time;
    /// Limits [rad/s], [rad/s2], [rad/s3], all > 0: none, one for every axis, or one for each axis.
    std::vector<double> velocity;
    std::vector<double> acceleration;
    std::vector<double> jerk;
    /// Lowest and highest position of axes without a range [rad]; empty or both.
    std::vector<double> position;
    /// Working position, one value for each axis [rad]; empty: the SRDF file's state "home", else
    /// one that is searched.
    std::vector<double> home;
    /// Takes angles of frames within 1e-4 rad of a multiple of 15 degrees for that multiple.
    bool round_angles = false;
};

/// A robot model made from a URDF file, and what a person has to know of it.
struct ImportedRobot {
    motion::RobotModel model;
    /// The model file; RobotModel::parse() gives `model`.
    std::string text;
    /// Link whose frame is the base frame.
    std::string base;
    /// Link whose frame is the flange.
    std::string tip;
    /// Number of axes, base and tip, and how the tip was chosen.
    std::string chain;
    /// Moves that can be planned with this chain, and by which inverse kinematics.
    std::string planning;
    /// Values that neither the files nor the options give, one sentence each.
    std::vector<std::string> assumed;
    /// Elements that were left out, one sentence each, with lines.
    std::vector<std::string> left_out;
    /// Other remarks, one sentence each.
    std::vector<std::string> remarks;
};

/// Makes a robot model from a URDF file and, if there is one, the SRDF file that goes with it.
/// Errors: invalid_argument with a line "file:line: <element>: reason" for each error, all
///         together; or the option that is wrong.
/// Threads: any; pure, takes up to a second.
Result<ImportedRobot> importUrdf(const SourceFile& urdf, const std::optional<SourceFile>& srdf,
                                 const ImportOptions& options);

/// Moves that can be planned with a robot's kinematics, in words.
std::string planningOf(const motion::RobotModel& model);

}  // namespace metier::robot_files
