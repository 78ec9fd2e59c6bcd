#include "closed_form.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "axis_rotation.hpp"

namespace metier::motion {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Three turns whose product is a given rotation.
struct Decomposition {
    std::array<std::array<AxisRotation, 3>, 2> turns;
    std::size_t count = 0;
    bool delicate = false;
};

struct ThreeAxes {
    Vector3d first;
    Vector3d second;
    Vector3d third;
};

/// rotation = R(first) R(second) R(third). Where the outer axes align, `otherwise` is the first.
Decomposition decompose(const Matrix3d& rotation, const ThreeAxes& axes,
                        const AxisRotation& otherwise) {
    const Vector3d image = rotation * axes.third;
    const AxisRotations second = rotationsOntoPlane({axes.first, axes.first.dot(image)}, axes.third,
                                                    axes.second, AxisRotation{});
    const Vector3d across = axes.third.unitOrthogonal();
    const Vector3d across_image = rotation * across;
    Decomposition result;
    result.delicate = second.delicate;
    for (std::size_t i = 0; i < second.count; ++i) {
        const Vector3d turned = rotate(axes.second, second.value[i], axes.third);
        const bool free = axes.first.cross(turned).squaredNorm() < kFree * kFree;
        const AxisRotation first =
            free ? otherwise : rotationBetween(turned, image, axes.first, otherwise);
        const Vector3d back = rotate(axes.second, second.value[i].inverse(),
                                     rotate(axes.first, first.inverse(), across_image));
        const AxisRotation third = rotationBetween(across, back, axes.third, AxisRotation{});
        result.turns[result.count++] = {first, second.value[i], third};
    }
    return result;
}

void add(ClosedFormSolutions& result, const JointVector& solution, bool delicate) {
    if (result.solutions.size() < JointSolutions::kCapacity) {
        result.delicate[result.solutions.size()] = delicate;
        result.solutions.add(solution);
    }
}

void noteMiss(ClosedFormSolutions& result, const ReachMiss& miss) {
    if (!result.miss || miss.excess() < result.miss->excess()) {
        result.miss = miss;
    }
}

/// Two links of these lengths cannot reach that far, or that near.
void noteLinks(ClosedFormSolutions& result, double distance, double first, double second) {
    const double longest = first + second;
    const double limit = distance > longest ? longest : std::abs(first - second);
    noteMiss(result, {"the wrist", 1, distance, limit});
}

/// The length of a vector across an axis.
double across(const Vector3d& v, const Vector3d& axis) {
    return axis.cross(v).norm();
}

/// Common part of arms whose axes 2 and 3 are parallel: two links in a plane.
struct PlanarPair {
    std::array<AxisRotation, 2> second;
    std::array<AxisRotation, 2> third;
    std::size_t count = 0;
    bool delicate = false;
};

/// AxisRotations of axes 2 and 3 for which R2 (p23 + R3 p3e) = end.
PlanarPair solvePlanarPair(const ZeroPosition& zero, const Vector3d& p3e, const Vector3d& end,
                           const AxisRotation& otherwise) {
    const Vector3d p23 = zero.point[2] - zero.point[1];
    const double distance = (end.squaredNorm() - p23.squaredNorm() - p3e.squaredNorm()) / 2;
    const AxisRotations third =
        rotationsOntoPlane({p23, distance, zero.slack}, p3e, zero.axis[2], AxisRotation{});
    PlanarPair pair;
    pair.delicate = third.delicate;
    for (std::size_t i = 0; i < third.count; ++i) {
        const Vector3d reached = p23 + rotate(zero.axis[2], third.value[i], p3e);
        pair.second[i] = rotationBetween(reached, end, zero.axis[1], otherwise);
        pair.third[i] = third.value[i];
    }
    pair.count = third.count;
    return pair;
}

struct Target {
    Matrix3d turned;  ///< rotation of the flange against its zero position
    Vector3d wrist;   ///< point at which the last axes meet
};

Target targetOf(const ZeroPosition& zero, const Transform& base_from_flange, std::size_t last) {
    Target target;
    target.turned = base_from_flange.rotation * zero.base_from_flange.rotation.transpose();
    target.wrist = base_from_flange.translation -
                   target.turned * (zero.base_from_flange.translation - zero.point[last]);
    return target;
}

bool parallel(const Vector3d& a, const Vector3d& b) {
    return a.cross(b).norm() < 1e-9;
}

/// The point on both axes, if they meet in one.
std::optional<Vector3d> meet(const ZeroPosition& zero, std::size_t i, std::size_t k) {
    const Vector3d normal = zero.axis[i].cross(zero.axis[k]);
    const Vector3d between = zero.point[k] - zero.point[i];
    if (normal.norm() < 1e-9 || std::abs(between.dot(normal)) > 1e-9) {
        return std::nullopt;
    }
    const double along = between.cross(zero.axis[k]).dot(normal) / normal.squaredNorm();
    return zero.point[i] + along * zero.axis[i];
}

/// The point where axes i, i+1, i+2 all meet.
std::optional<Vector3d> meetOfThree(const ZeroPosition& zero, std::size_t i) {
    auto first = meet(zero, i, i + 1);
    const auto second = meet(zero, i + 1, i + 2);
    if (!first || !second || (*first - *second).norm() > 1e-9) {
        return std::nullopt;
    }
    return first;
}

IkKind recogniseSixAxes(ZeroPosition& zero) {
    const auto& axis = zero.axis;
    if (parallel(axis[0], axis[1]) || !parallel(axis[1], axis[2])) {
        return IkKind::numeric;
    }
    if (const auto wrist = meetOfThree(zero, 3)) {
        zero.point[3] = zero.point[4] = zero.point[5] = *wrist;
        return IkKind::spherical_wrist;
    }
    const auto wrist = meet(zero, 4, 5);
    if (wrist && parallel(axis[2], axis[3]) && !parallel(axis[3], axis[4])) {
        zero.point[4] = zero.point[5] = *wrist;
        return IkKind::three_parallel_axes;
    }
    return IkKind::numeric;
}

IkKind recogniseSevenAxes(ZeroPosition& zero) {
    const auto shoulder = meetOfThree(zero, 0);
    const auto wrist = meetOfThree(zero, 4);
    if (!shoulder || !wrist) {
        return IkKind::numeric;
    }
    const Vector3d line = *wrist - *shoulder;
    if (parallel(zero.axis[3], line.normalized())) {
        return IkKind::numeric;
    }
    zero.point[0] = zero.point[1] = zero.point[2] = *shoulder;
    zero.point[4] = zero.point[5] = zero.point[6] = *wrist;
    return IkKind::arm_angle;
}

/// Points of two axes where they are nearest to each other; axes not parallel.
std::pair<Vector3d, Vector3d> nearestPoints(const ZeroPosition& zero, std::size_t i,
                                            std::size_t k) {
    const Vector3d normal = zero.axis[i].cross(zero.axis[k]);
    const Vector3d between = zero.point[k] - zero.point[i];
    const double square = normal.squaredNorm();
    return {zero.point[i] + between.cross(zero.axis[k]).dot(normal) / square * zero.axis[i],
            zero.point[k] + between.cross(zero.axis[i]).dot(normal) / square * zero.axis[k]};
}

/// The mean direction of axes 2, 3 and 4, as axis 2; nothing if one is too far off.
std::optional<Vector3d> commonDirection(const ZeroPosition& zero) {
    constexpr double largest = 0.02;  // [rad]
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 1; i < 4; ++i) {
        sum += zero.axis[i].dot(zero.axis[1]) < 0 ? Vector3d(-zero.axis[i]) : zero.axis[i];
    }
    sum.normalize();
    for (std::size_t i = 1; i < 4; ++i) {
        if (zero.axis[i].cross(sum).norm() > largest) {
            return std::nullopt;
        }
    }
    return sum;
}

}  // namespace

bool idealise(ZeroPosition& zero) {
    constexpr double farthest = 0.01;  // [m]
    const auto direction = commonDirection(zero);
    if (!direction || zero.axis[0].cross(*direction).norm() < 0.5 ||
        zero.axis[3].cross(zero.axis[4]).norm() < 0.5 ||
        zero.axis[4].cross(zero.axis[5]).norm() < 0.5) {
        return false;
    }
    const auto [wrist5, wrist6] = nearestPoints(zero, 4, 5);
    if ((wrist5 - wrist6).norm() > farthest) {
        return false;
    }
    std::tie(zero.point[0], zero.point[1]) = nearestPoints(zero, 0, 1);
    for (std::size_t i = 1; i < 4; ++i) {
        // The place on the axis beside that of axis 2: there the turn of its direction shows least.
        const double along = direction->dot(zero.point[1] - zero.point[i]);
        zero.point[i] += along / direction->dot(zero.axis[i]) * zero.axis[i];
        zero.axis[i] = zero.axis[i].dot(*direction) < 0 ? Vector3d(-*direction) : *direction;
    }
    zero.point[4] = zero.point[5] = 0.5 * (wrist5 + wrist6);
    zero.slack = 0.02;
    return true;
}

IkKind recogniseStructure(std::size_t axis_count, ZeroPosition& zero) {
    switch (axis_count) {
        case 6:
            return recogniseSixAxes(zero);
        case 7:
            return recogniseSevenAxes(zero);
        default:
            return IkKind::numeric;
    }
}

ClosedFormSolutions solveThreeParallelAxes(const ZeroPosition& zero, const ClosedFormQuery& query) {
    const auto& axis = zero.axis;
    const JointVector& reference = query.reference;
    const Target target = targetOf(zero, query.base_from_flange, 4);
    const Vector3d from_first = target.wrist - zero.point[0];
    const Vector3d p23 = zero.point[2] - zero.point[1];
    const Vector3d p34 = zero.point[3] - zero.point[2];
    const Vector3d p45 = zero.point[4] - zero.point[3];
    const double offset = axis[1].dot(zero.point[4] - zero.point[0]);
    const double sign3 = axis[2].dot(axis[1]);
    const double sign4 = axis[3].dot(axis[1]);
    const ThreeAxes wrist_axes{axis[5], axis[4], axis[1]};

    ClosedFormSolutions result;
    // axis[1] . R1^-1 x = offset, written as a plane for x turned back about axis 1.
    const AxisRotations back1 = rotationsOntoPlane({axis[1], offset, zero.slack}, from_first,
                                                   axis[0], AxisRotation::of(-reference[0]));
    if (back1.count == 0) {
        noteMiss(result, {"the wrist", 0, across(from_first, axis[0]), std::abs(offset)});
    }
    for (std::size_t i = 0; i < back1.count; ++i) {
        const AxisRotation turn1 = back1.value[i].inverse();
        const double q1 = turn1.angle();
        const Matrix3d unturned = rotationMatrix(axis[0], back1.value[i]);
        // R1^-1 R = R(axis 2, q2 +- q3 +- q4) R5 R6: solved backwards, so that q6 may be free.
        const Matrix3d wrist = (unturned * target.turned).transpose();
        const Decomposition wrists = decompose(wrist, wrist_axes, AxisRotation::of(-reference[5]));
        const Vector3d from_second =
            rotate(axis[0], back1.value[i], from_first) - (zero.point[1] - zero.point[0]);
        for (std::size_t k = 0; k < wrists.count; ++k) {
            const double q6 = -wrists.turns[k][0].angle();
            const double q5 = -wrists.turns[k][1].angle();
            const AxisRotation sum = wrists.turns[k][2].inverse();
            const Vector3d end = from_second - rotate(axis[1], sum, p45);
            const PlanarPair pair = solvePlanarPair(zero, p34, end, AxisRotation::of(reference[1]));
            if (pair.count == 0) {
                noteLinks(result, across(end, axis[1]), across(p23, axis[1]), across(p34, axis[1]));
            }
            for (std::size_t m = 0; m < pair.count; ++m) {
                const AxisRotation third = sign3 > 0 ? pair.third[m] : pair.third[m].inverse();
                const AxisRotation fourth = sum * (pair.second[m] * third).inverse();
                const double q4 = sign4 > 0 ? fourth.angle() : -fourth.angle();
                add(result, {q1, pair.second[m].angle(), pair.third[m].angle(), q4, q5, q6},
                    back1.delicate || wrists.delicate || pair.delicate);
            }
        }
    }
    return result;
}

ClosedFormSolutions solveSphericalWrist(const ZeroPosition& zero, const ClosedFormQuery& query) {
    const auto& axis = zero.axis;
    const JointVector& reference = query.reference;
    const Target target = targetOf(zero, query.base_from_flange, 5);
    const Vector3d from_first = target.wrist - zero.point[0];
    const Vector3d p23 = zero.point[2] - zero.point[1];
    const Vector3d p3w = zero.point[3] - zero.point[2];
    const double offset = axis[1].dot(zero.point[3] - zero.point[0]);
    const ThreeAxes wrist_axes{axis[3], axis[4], axis[5]};

    ClosedFormSolutions result;
    const AxisRotations back1 =
        rotationsOntoPlane({axis[1], offset}, from_first, axis[0], AxisRotation::of(-reference[0]));
    if (back1.count == 0) {
        noteMiss(result, {"the wrist", 0, across(from_first, axis[0]), std::abs(offset)});
    }
    for (std::size_t i = 0; i < back1.count; ++i) {
        const double q1 = -back1.value[i].angle();
        const Vector3d end =
            rotate(axis[0], back1.value[i], from_first) - (zero.point[1] - zero.point[0]);
        const PlanarPair pair = solvePlanarPair(zero, p3w, end, AxisRotation::of(reference[1]));
        if (pair.count == 0) {
            noteLinks(result, across(end, axis[1]), across(p23, axis[1]), across(p3w, axis[1]));
        }
        const Matrix3d unturned = rotationMatrix(axis[0], back1.value[i]) * target.turned;
        for (std::size_t m = 0; m < pair.count; ++m) {
            const Matrix3d wrist = rotationMatrix(axis[2], pair.third[m].inverse()) *
                                   (rotationMatrix(axis[1], pair.second[m].inverse()) * unturned);
            const Decomposition wrists =
                decompose(wrist, wrist_axes, AxisRotation::of(reference[3]));
            const double q2 = pair.second[m].angle();
            const double q3 = pair.third[m].angle();
            for (std::size_t k = 0; k < wrists.count; ++k) {
                const auto& turns = wrists.turns[k];
                add(result, {q1, q2, q3, turns[0].angle(), turns[1].angle(), turns[2].angle()},
                    back1.delicate || wrists.delicate || pair.delicate);
            }
        }
    }
    return result;
}

ArmPlane armPlane(const Vector3d& shoulder_to_wrist) {
    constexpr double vertical = 1e-6;
    ArmPlane plane;
    plane.along = shoulder_to_wrist.normalized();
    Vector3d up = Vector3d::UnitZ() - plane.along.z() * plane.along;
    if (up.norm() < vertical) {
        up = Vector3d::UnitX() - plane.along.x() * plane.along;
    }
    plane.up = up.normalized();
    plane.side = plane.along.cross(plane.up);
    return plane;
}

namespace {

/// The upper arm's rotation that brings `line` to the plane's line and `normal` to the arm angle.
Matrix3d shoulderRotation(const ArmPlane& plane, const AxisRotation& angle, const Vector3d& line,
                          const Vector3d& normal) {
    const Vector3d target_normal = angle.c * plane.up + angle.s * plane.side;
    Matrix3d from;
    from << line, normal, line.cross(normal);
    Matrix3d to;
    to << plane.along, target_normal, plane.along.cross(target_normal);
    return to * from.transpose();
}

struct ArmHalves {
    Decomposition shoulder;
    Decomposition wrist;
    double q4 = 0;
    bool delicate = false;
};

void addCombinations(ClosedFormSolutions& result, const ArmHalves& halves) {
    for (std::size_t i = 0; i < halves.shoulder.count; ++i) {
        const auto& s = halves.shoulder.turns[i];
        const double q1 = s[0].angle();
        const double q2 = s[1].angle();
        const double q3 = s[2].angle();
        for (std::size_t k = 0; k < halves.wrist.count; ++k) {
            const auto& w = halves.wrist.turns[k];
            add(result, {q1, q2, q3, halves.q4, w[0].angle(), w[1].angle(), w[2].angle()},
                halves.delicate || halves.shoulder.delicate || halves.wrist.delicate);
        }
    }
}

}  // namespace

ClosedFormSolutions solveArmAngle(const ZeroPosition& zero, const ClosedFormQuery& query) {
    const auto& axis = zero.axis;
    const Target target = targetOf(zero, query.base_from_flange, 6);
    const Vector3d shoulder_to_wrist = target.wrist - zero.point[0];
    const Vector3d upper = zero.point[3] - zero.point[0];
    const Vector3d fore = zero.point[4] - zero.point[3];
    const double distance =
        (shoulder_to_wrist.squaredNorm() - upper.squaredNorm() - fore.squaredNorm()) / 2;
    const AxisRotations elbow =
        rotationsOntoPlane({upper, distance}, fore, axis[3], AxisRotation{});
    ClosedFormSolutions result;
    if (elbow.count == 0) {
        noteLinks(result, shoulder_to_wrist.norm(), upper.norm(), fore.norm());
    }
    if (shoulder_to_wrist.norm() < kFree) {
        return result;
    }
    const ArmPlane plane = armPlane(shoulder_to_wrist);
    const AxisRotation angle = AxisRotation::of(query.redundancy_angle);
    for (std::size_t i = 0; i < elbow.count; ++i) {
        const Vector3d line = (upper + rotate(axis[3], elbow.value[i], fore)).normalized();
        const Vector3d normal = axis[3].cross(line).normalized();
        const AxisRotation side = upper.dot(normal) < 0 ? AxisRotation{-angle.c, -angle.s} : angle;
        const Matrix3d shoulder = shoulderRotation(plane, side, line, normal);
        const Matrix3d wrist = rotationMatrix(axis[3], elbow.value[i].inverse()) *
                               (shoulder.transpose() * target.turned);
        ArmHalves halves;
        halves.shoulder =
            decompose(shoulder, {axis[0], axis[1], axis[2]}, AxisRotation::of(query.reference[0]));
        halves.wrist =
            decompose(wrist, {axis[4], axis[5], axis[6]}, AxisRotation::of(query.reference[4]));
        halves.q4 = elbow.value[i].angle();
        halves.delicate = elbow.delicate;
        addCombinations(result, halves);
    }
    return result;
}

}  // namespace metier::motion
