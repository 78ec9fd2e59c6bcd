#pragma once

#include <array>
#include <vector>

#include "metier/motion/profile.hpp"

namespace metier::motion {

/// Path parameter as a function of the clock: a clock that runs at speed 1 stays within every limit
/// of axes and tool frame.
class SpeedMap {
public:
    /// The whole path at one speed. \param speed of the path parameter [1/s], > 0
    static SpeedMap constant(double speed);
    /// \param places path parameters, rising from 0 to 1
    /// \param speed there, > 0
    /// \param slope d(speed^2/2)/ds there
    static SpeedMap varying(const std::vector<double>& places, const std::vector<double>& speed,
                            const std::vector<double>& slope);

    double end() const noexcept { return end_; }
    /// s, ds/dclock and d2s/dclock2.
    ScalarState at(double clock) const noexcept;
    /// d3s/dclock3; at a node that after it.
    double jerkAt(double clock) const noexcept;
    /// The clock where the path parameter is `s`, 0 to 1.
    double clockAt(double s) const noexcept;

private:
    struct Node {
        double clock = 0;
        ScalarState s;
    };
    /// The quintic from node to node with the speeds and slopes of both.
    struct Quintic {
        double length;            ///< by the clock
        double u;                 ///< share of it that has passed
        std::array<double, 6> c;  ///< factors of the powers of u
    };
    Quintic around(double clock) const noexcept;

    double speed_ = 1;
    double end_ = 0;
    std::vector<Node> nodes_;
};

}  // namespace metier::motion
