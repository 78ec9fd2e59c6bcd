#pragma once

#include <cstdint>

#include "axes.hpp"
#include "metier/base/error.hpp"
#include "metier/motion/robot_model.hpp"
#include "movement.hpp"
#include "segment.hpp"

namespace metier::virtual_edo {

/// Plans the robot's moves and jogs: joint moves in which all axes arrive together, lines and arcs
/// of the tool frame.
///
/// Stands for Comau's closed trajectory library: what it refuses and how it rounds corners are this
/// simulation's own.
///
/// Threading: one thread.
class MovePlanner {
public:
    /// \param model of an arm of six axes; outlives the planner
    explicit MovePlanner(const motion::RobotModel& model);

    /// A move from a standing start. An override of 0 keeps the last one.
    /// Errors: out_of_range (stroke), unreachable, not_supported.
    Result<Segment> planMove(const AxisValues& start, std::size_t axes, const Movement& movement);

    /// A jog to the end of the stroke or of the reach, at half of the speed and below.
    /// Errors: invalid_argument (kind of point), unreachable.
    Result<Segment> planJog(const AxisValues& start, std::size_t axes, const Movement& movement);

    /// Pose of the last move's tool in its frame.
    CartesianPose cartesian(const AxisValues& position) const;
    motion::Pose baseFromFlange(const AxisValues& position) const;
    /// Errors: unreachable.
    Result<AxisValues> inverse(const AxisValues& near, const motion::Pose& base_from_flange) const;
    const AxisLimits& limits() const { return limits_; }

private:
    struct ToolPath;  // path of the tool frame

    Result<AxisValues> jointTarget(const AxisValues& start, std::size_t axes,
                                   const Point& point) const;
    Result<AxisValues> moveTarget(const AxisValues& start, std::size_t axes,
                                  const Point& point) const;
    Result<Segment> planLine(const AxisValues& start, const AxisValues& target,
                             const motion::Pose& goal) const;
    Result<Segment> planArc(const AxisValues& start, const AxisValues& via,
                            const AxisValues& target) const;
    Result<Segment> follow(const AxisValues& start, const AxisValues& target,
                           const ToolPath& way) const;
    Result<Segment> planJoints(const AxisValues& start, const AxisValues& target) const;
    AxisValues jogTarget(const AxisValues& start, std::size_t axes, const Point& point);
    Result<Segment> planLinearJog(const AxisValues& start, const CartesianPose& direction);
    motion::Pose flangeGoal(const CartesianPose& target) const;
    virtual_controller::Trapezoid profileFor(const std::vector<AxisValues>& path, double length,
                                             double angle) const;
    void setReference(const Movement& movement);

    const motion::RobotModel& model_;
    AxisLimits limits_;
    double override_ = 1.0;  // part of the full speed
    motion::Pose base_from_frame_;
    motion::Pose flange_from_tool_;
};

}  // namespace metier::virtual_edo
