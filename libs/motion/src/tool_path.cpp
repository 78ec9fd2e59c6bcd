#include "tool_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "metier/motion/rotation.hpp"

namespace metier::motion {

namespace {

using Eigen::Vector3d;

/// Length that a rotation counts for where it is more than the translation [m/rad].
constexpr double kLengthPerAngle = 0.25;

constexpr double kLongestPathStep = 0.005;  // [m]
constexpr double kLongestTurn = 0.03;       // [rad]
constexpr double kFewestStepsOfAPath = 16;  // without corners
constexpr double kFewestStepsOfACorner = 16;
constexpr double kFewestStepsOfALine = 4;    // between corners
constexpr double kShortestPathStep = 1e-12;  // shortest step along the path
/// Growth of the steps beside a corner, per distance to it.
constexpr double kGrowth = 0.4;

/// The smooth step from 0 to 1, its first two derivatives and its integral.
struct Fade {
    double value;
    double first;
    double second;
    double integral;
};

Fade fade(double u) noexcept {
    const double u2 = u * u;
    return {u2 * u * (10 + u * (-15 + 6 * u)), 30 * u2 * (1 - u) * (1 - u),
            60 * u * (1 + u * (-3 + 2 * u)), u2 * u2 * (2.5 + u * (u - 3))};
}

ToolDerivatives cornerDerivatives(const Vector3d& in, const Vector3d& out, const Fade& f,
                                  double length) noexcept {
    const double change = (out - in).norm();
    return {((1 - f.value) * in + f.value * out).norm(), std::abs(f.first) * change / length,
            std::abs(f.second) * change / (length * length)};
}

ToolDerivatives scaled(const ToolDerivatives& d, double length) noexcept {
    return {d.first * length, d.second * length * length, d.third * length * length * length};
}

/// Place of the minimum of a function that has only one.
template <typename Function>
double leastBetween(double low, double high, const Function& function) noexcept {
    constexpr int steps = 60;
    for (int i = 0; i < steps && low < high; ++i) {
        const double third = (high - low) / 3;
        if (function(low + third) < function(high - third)) {
            high -= third;
        } else {
            low += third;
        }
    }
    return (low + high) / 2;
}

double share(const Vector3d& part, const Vector3d& whole) noexcept {
    return part.dot(whole) / whole.squaredNorm();
}

}  // namespace

ToolPath::ToolPath(const Pose& start, const Pose& target) : end_(start) {
    appendLine(start, target);
}

ToolPath::Piece ToolPath::lineBetween(const Pose& start, const Pose& target) {
    const Vector3d direction = target.translation - start.translation;
    const Vector3d turn = rotationVectorBetween(start.rotation, target.rotation);
    Piece piece;
    piece.length = std::max(direction.norm(), kLengthPerAngle * turn.norm());
    piece.whole = piece.length;
    piece.pose = start;
    if (piece.length > 0) {
        piece.in = {direction / piece.length, turn / piece.length};
    }
    return piece;
}

void ToolPath::appendLine(const Pose& start, const Pose& target) {
    Piece piece = lineBetween(start, target);
    piece.begin = length_;
    piece.line = line_count_++;
    length_ += piece.length;
    distance_ += piece.length * piece.in.velocity.norm();
    angle_ += piece.length * piece.in.spin.norm();
    end_ = target;
    pieces_.push_back(piece);
}

ToolPath::BlendRange ToolPath::blendRange(const Pose& target) const noexcept {
    constexpr double least_radius = 1e-9;
    constexpr double least_length = 1e-6;
    const Piece& from = pieces_.back();
    const Piece to = lineBetween(end_, target);
    const double fastest = std::max(from.in.velocity.norm(), to.in.velocity.norm());
    return {std::max(least_radius, least_length * fastest),
            from.whole > 0 && fastest > 0 ? 0.5 * std::min(from.whole, to.whole) * fastest
                                          : std::numeric_limits<double>::infinity()};
}

void ToolPath::append(const Pose& target, double blend_radius) {
    const std::size_t before = pieces_.size() - 1;
    const Pose corner_pose = end_;
    appendLine(corner_pose, target);
    Piece& from = pieces_[before];
    Piece& to = pieces_[before + 1];
    const double fastest = std::max({from.in.velocity.norm(), to.in.velocity.norm(), 1e-9});
    const double half = std::min(
        {blend_radius / fastest, 0.5 * from.whole, 0.5 * to.whole, from.length, to.length});
    if (half <= 0) {
        return;
    }
    Piece corner;
    corner.corner = true;
    corner.begin = from.begin + from.length - half;
    corner.length = 2 * half;
    corner.pose = corner_pose;
    corner.in = from.in;
    corner.out = to.in;
    corner.line = from.line;
    from.length -= half;
    to.begin += half;
    to.length -= half;
    to.pose = {to.pose.translation + half * to.in.velocity,
               fromRotationVector(half * to.in.spin) * to.pose.rotation};
    pieces_.insert(pieces_.begin() + static_cast<std::ptrdiff_t>(before) + 1, corner);
}

double ToolPath::longestStep(const Piece& piece) noexcept {
    const double speed = std::max(piece.in.velocity.norm(), piece.out.velocity.norm());
    const double spin = std::max(piece.in.spin.norm(), piece.out.spin.norm());
    return 1 / std::max({speed / kLongestPathStep, spin / kLongestTurn, 1e-9});
}

double ToolPath::cornerStep(const Piece& piece) noexcept {
    return std::min(piece.length / kFewestStepsOfACorner, longestStep(piece));
}

void ToolPath::addPlaces(std::size_t piece, double density, std::vector<double>& places) const {
    const Piece& here = pieces_[piece];
    const double fewest = pieces_.size() == 1 ? kFewestStepsOfAPath : kFewestStepsOfALine;
    const double longest = std::min(longestStep(here), here.length / fewest);
    const auto beside = [&](std::size_t i) {
        return i < pieces_.size() && pieces_[i].corner ? cornerStep(pieces_[i]) : longest;
    };
    const double first = beside(piece - 1);
    const double last = beside(piece + 1);
    std::vector<double> along;
    if (here.corner) {
        // The middle is a place too: there one line gives way to the next.
        const double half = std::ceil(here.length * density / (2 * cornerStep(here)) - 1e-9);
        for (int n = 1; n <= 2 * static_cast<int>(half); ++n) {
            along.push_back(n * here.length / (2 * half));
        }
    }
    for (double at = 0; !here.corner && at < here.length;) {
        const double step = std::min(
            {longest, first + kGrowth * at, last + kGrowth / (1 + kGrowth) * (here.length - at)});
        at += std::max(step / density, kShortestPathStep * length_);
        along.push_back(at);
    }
    for (const double at : along) {
        places.push_back((here.begin + at * here.length / along.back()) / length_);
    }
}

std::vector<double> ToolPath::places(double density) const {
    // A line that its corners have used up may be left with a length of rounding.
    constexpr double least = 0.05;
    std::vector<double> places{0.0};
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
        double shortest = kShortestPathStep * length_;
        for (const std::size_t beside : {i - 1, i + 1}) {
            const bool corner = beside < pieces_.size() && pieces_[beside].corner;
            shortest = corner ? std::max(shortest, least * cornerStep(pieces_[beside])) : shortest;
        }
        if (pieces_[i].corner || pieces_[i].length > shortest) {
            addPlaces(i, density, places);
        }
    }
    places.back() = 1.0;
    return places;
}

const ToolPath::Piece& ToolPath::pieceAt(double length) const noexcept {
    const auto after =
        std::upper_bound(pieces_.begin() + 1, pieces_.end(), length,
                         [](double value, const Piece& piece) { return value < piece.begin; });
    return *(after - 1);
}

double ToolPath::wayOut(const Piece& corner, double along) noexcept {
    return corner.length * fade(along / corner.length).integral;
}

double ToolPath::wayIn(const Piece& corner, double along) noexcept {
    return along - wayOut(corner, along) - corner.length / 2;
}

Vector3d ToolPath::translationIn(const Piece& corner, double along) noexcept {
    return corner.pose.translation + wayIn(corner, along) * corner.in.velocity +
           wayOut(corner, along) * corner.out.velocity;
}

Pose ToolPath::at(double s) const noexcept {
    const double length = s * length_;
    const Piece& piece = pieceAt(length);
    const double along = length - piece.begin;
    if (!piece.corner) {
        return {piece.pose.translation + along * piece.in.velocity,
                fromRotationVector(along * piece.in.spin) * piece.pose.rotation};
    }
    const double out = wayOut(piece, along);
    const double in = wayIn(piece, along);
    return {translationIn(piece, along), fromRotationVector(out * piece.out.spin) *
                                             fromRotationVector(in * piece.in.spin) *
                                             piece.pose.rotation};
}

ToolDerivatives ToolPath::translationAt(double s) const noexcept {
    const Piece& piece = pieceAt(s * length_);
    if (!piece.corner) {
        return {length_ * piece.in.velocity.norm(), 0, 0};
    }
    const Fade f = fade((s * length_ - piece.begin) / piece.length);
    return scaled(cornerDerivatives(piece.in.velocity, piece.out.velocity, f, piece.length),
                  length_);
}

ToolDerivatives ToolPath::rotationAt(double s) const noexcept {
    const Piece& piece = pieceAt(s * length_);
    if (!piece.corner) {
        return {length_ * piece.in.spin.norm(), 0, 0};
    }
    const Fade f = fade((s * length_ - piece.begin) / piece.length);
    ToolDerivatives d = cornerDerivatives(piece.in.spin, piece.out.spin, f, piece.length);
    // If both rotations run at once, one turns the axis of the other.
    d.second += piece.in.spin.norm() * piece.out.spin.norm();
    return scaled(d, length_);
}

std::size_t ToolPath::lineAt(double s) const noexcept {
    const Piece& piece = pieceAt(s * length_);
    const bool second_half = piece.corner && s * length_ > piece.begin + piece.length / 2;
    return piece.line + (second_half ? 1 : 0);
}

double ToolPath::nearestOn(const Piece& piece, const Pose& pose) const noexcept {
    const auto clamped = [&](double along) {
        return (piece.begin + std::clamp(along, 0.0, piece.length)) / length_;
    };
    if (!piece.corner) {
        const bool moves = piece.in.velocity.norm() > 0;
        return clamped(moves ? share(pose.translation - piece.pose.translation, piece.in.velocity)
                             : share(rotationVectorBetween(piece.pose.rotation, pose.rotation),
                                     piece.in.spin));
    }
    return clamped(nearestInCorner(piece, pose.translation));
}

/// Far round a corner the path comes near its beginning again: each of its sections that could hold
/// the nearest place is searched.
double ToolPath::nearestInCorner(const Piece& piece, const Vector3d& point) noexcept {
    constexpr int sections = 64;
    const double section = piece.length / sections;
    const double reach = section * std::max(piece.in.velocity.norm(), piece.out.velocity.norm());
    const auto off = [&](double along) { return (translationIn(piece, along) - point).norm(); };
    double best = 0;
    double least = off(0);
    double before = least;
    for (int i = 0; i < sections; ++i) {
        const double after = off((i + 1) * section);
        if (std::min(before, after) - reach <= least) {
            const double along = leastBetween(i * section, (i + 1) * section, off);
            const double there = off(along);
            best = there < least ? along : best;
            least = std::min(least, there);
        }
        before = after;
    }
    return best;
}

/// A corner is searched, which takes time, only where the place could be nearer than on any line.
double ToolPath::nearest(const Pose& pose) const noexcept {
    double best = 0;
    double least = -1;
    for (const bool corners : {false, true}) {
        for (const Piece& piece : pieces_) {
            if (piece.corner != corners || piece.length <= 0 ||
                (least >= 0 && nearestPossible(piece, pose) > least)) {
                continue;
            }
            const double s = nearestOn(piece, pose);
            const double off = distanceBetween(at(s), pose);
            if (least < 0 || off < least) {
                least = off;
                best = s;
            }
        }
    }
    return best;
}

double ToolPath::nearestPossible(const Piece& piece, const Pose& pose) noexcept {
    if (!piece.corner) {
        return 0;
    }
    const double reach =
        0.5 * piece.length * std::max(piece.in.velocity.norm(), piece.out.velocity.norm());
    return distanceBetween(piece.pose, pose) - reach;
}

}  // namespace metier::motion
