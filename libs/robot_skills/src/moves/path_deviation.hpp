#pragma once

#include "metier/motion/trajectory.hpp"

namespace metier::robot_skills {

/// Measures how far the arm is off the path of one motion.
///
/// Threading: one thread, the cycle. Does not allocate.
class PathDeviationMeter {
public:
    enum class Path : std::uint8_t {
        joint_line,      ///< straight in joint space
        cartesian_line,  ///< straight for the tool frame
    };

    PathDeviationMeter(motion::Trajectory trajectory, Path path) noexcept;

    /// Takes a measured joint position.
    /// \return its place on the path, 0 start to 1 end
    double take(const motion::JointVector& measured) noexcept;

    /// Largest distance of the tool frame from its path so far [m].
    double largest() const noexcept { return largest_; }

private:
    motion::PathDeviation fromJointLine(const motion::JointVector& measured) const noexcept;

    motion::Trajectory trajectory_;
    Path path_;
    double largest_ = 0.0;
};

}  // namespace metier::robot_skills
