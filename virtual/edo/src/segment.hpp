#pragma once

#include <vector>

#include "axes.hpp"
#include "metier/virtual_controller/trapezoid.hpp"

namespace metier::virtual_edo {

/// One move of all axes along a path of joint positions.
class Segment {
public:
    /// \param path    at least two positions, evenly spaced along the way
    /// \param profile progress along it, from 0 to 1
    Segment(std::vector<AxisValues> path, virtual_controller::Trapezoid profile);

    AxisValues at(double seconds) const;
    const AxisValues& start() const { return path_.front(); }
    const AxisValues& end() const { return path_.back(); }
    double duration() const { return profile_.duration(); }
    double brakingFrom() const { return profile_.brakingFrom(); }

private:
    std::vector<AxisValues> path_;
    virtual_controller::Trapezoid profile_;
};

}  // namespace metier::virtual_edo
