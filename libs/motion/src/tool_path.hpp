#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "metier/motion/pose.hpp"

namespace metier::motion {

/// Derivatives of the tool frame by the path parameter at a place of the path; lengths of vectors.
struct ToolDerivatives {
    double first = 0;
    double second = 0;
    double third = 0;
};

/// Path of a tool frame: straight lines with short-way rotation, their corners rounded.
///
/// In a corner the derivative by the path parameter fades from that of one line into that of the
/// next, twice continuously differentiable: velocity and angular velocity have no jump, and the
/// path stays in the triangle of the corner. Path parameter 0 to 1.
class ToolPath {
public:
    ToolPath() = default;
    /// One line.
    ToolPath(const Pose& start, const Pose& target);

    /// Goes on in a line to `target`, rounding the corner where it leaves the last one.
    /// \param blend_radius > 0 [m]; no more than blendLimit() is used
    void append(const Pose& target, double blend_radius);
    /// Blend radii of a corner [m].
    struct BlendRange {
        double least = 0;
        double most = 0;
    };
    /// Possible blend radii of a corner from which a line leads to `target`. The largest is half of
    /// the shorter line, where a turn counts for 0.25 m/rad; infinite where nothing but the
    /// rotation changes, or the line before has no length. With the least, 1e-6 m of that length is
    /// cut: no arm shows a smaller corner, and the rounding of joint positions hides what it
    /// accelerates there.
    BlendRange blendRange(const Pose& target) const noexcept;

    bool isPoint() const noexcept { return length_ == 0; }
    /// Sum of all lines [m] and of all rotations [rad].
    double distance() const noexcept { return distance_; }
    double angle() const noexcept { return angle_; }
    /// Path parameters from 0 to 1 that show how the path bends: no two more than a step apart,
    /// more of them in a corner, and towards it, the smaller it is. \param density how many times
    /// as many as are usual, > 0
    std::vector<double> places(double density) const;

    Pose at(double s) const noexcept;
    ToolDerivatives translationAt(double s) const noexcept;
    ToolDerivatives rotationAt(double s) const noexcept;
    /// Line (0: the first) to which a place belongs. The first half of a corner belongs to the line
    /// before it, the second half to the line after it.
    std::size_t lineAt(double s) const noexcept;
    /// The path parameter where the path is nearest.
    double nearest(const Pose& pose) const noexcept;

    /// Translation and rotation vector of the only line, from start to end.
    Eigen::Vector3d direction() const noexcept { return length_ * pieces_.front().in.velocity; }
    Eigen::Vector3d turn() const noexcept { return length_ * pieces_.front().in.spin; }

private:
    /// Derivatives by the length.
    struct Motion {
        Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
        Eigen::Vector3d spin = Eigen::Vector3d::Zero();
    };
    struct Piece {
        double begin = 0;
        double length = 0;
        double whole = 0;  ///< length of a line with what its corners have taken
        Pose pose;         ///< pose at the begin of a line, or at the point of a corner
        Motion in;
        Motion out;  ///< motion at the end of a corner
        bool corner = false;
        std::size_t line = 0;
    };

    const Piece& pieceAt(double length) const noexcept;
    /// Adds the places of a line after its begin, its end included.
    void addPlaces(std::size_t piece, double density, std::vector<double>& places) const;
    static double longestStep(const Piece& piece) noexcept;
    static double cornerStep(const Piece& piece) noexcept;
    static Piece lineBetween(const Pose& start, const Pose& target);
    void appendLine(const Pose& start, const Pose& target);
    /// Ways along both lines of a corner, from its point: the first one's is negative [m].
    static double wayIn(const Piece& corner, double along) noexcept;
    static double wayOut(const Piece& corner, double along) noexcept;
    static Eigen::Vector3d translationIn(const Piece& corner, double along) noexcept;
    static double nearestInCorner(const Piece& piece, const Eigen::Vector3d& point) noexcept;
    double nearestOn(const Piece& piece, const Pose& pose) const noexcept;
    /// No place of the piece is nearer than that [m].
    static double nearestPossible(const Piece& piece, const Pose& pose) noexcept;

    std::vector<Piece> pieces_;
    Pose end_;
    double length_ = 0;
    double distance_ = 0;
    double angle_ = 0;
    std::size_t line_count_ = 0;
};

}  // namespace metier::motion
