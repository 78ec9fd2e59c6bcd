#include "path_layout.hpp"

#include "metier/motion/rotation.hpp"

namespace metier::motion {

namespace {

tl::unexpected<Refusal> atWaypoint(const PathRequest& request, std::size_t index, Refusal refusal) {
    refusal.error.message = fmt::format("waypoint {}: {}", index + 1, refusal.error.message);
    refusal.fraction =
        static_cast<double>(index + 1) / static_cast<double>(request.waypoints.size());
    return tl::unexpected(std::move(refusal));
}

/// Why the path cannot go on to a waypoint that it has a corner before.
Checked refuseCorner(const ToolPath& path, const Pose& corner, const Pose& target, double radius) {
    constexpr double rounding = 1e-9;
    const bool same = distanceBetween(corner, target) == 0 &&
                      rotationAngleBetween(corner.rotation, target.rotation) == 0;
    if (same) {
        return invalid("the next waypoint is the same pose: no line leads there");
    }
    const auto [least, most] = path.blendRange(target);
    if (radius < least) {
        return invalid(fmt::format("blend radius {} m under {:.3g} m: no arm could show the corner",
                                   radius, least),
                       Errc::out_of_range);
    }
    if (radius > most + rounding) {
        return invalid(
            fmt::format("blend radius {} m over {:.4f} m, half of the shorter line beside it",
                        radius, most),
            Errc::out_of_range);
    }
    return {};
}

}  // namespace

Pose absoluteTarget(const Pose& start, const Pose& target, TargetReference reference) {
    switch (reference) {
        case TargetReference::relative_base:
            return {start.translation + target.translation, target.rotation * start.rotation};
        case TargetReference::relative_tool:
            return start * target;
        case TargetReference::base:
            break;
    }
    return {target.translation, target.rotation.normalized()};
}

Checked layOut(const RobotModel& model, const PathRequest& request, const Pose& flange_from_tool,
               ToolPath& path) {
    const Pose tool_from_flange = flange_from_tool.inverse();
    Pose before = model.kinematics().forward(request.lin.start) * flange_from_tool;
    for (std::size_t i = 0; i < request.waypoints.size(); ++i) {
        const Pose target =
            absoluteTarget(before, request.waypoints[i].target, request.lin.reference);
        const bool named = request.waypoints.size() > 1;
        const auto miss =
            model.kinematics().outOfReach(target * tool_from_flange, request.lin.start);
        if (miss && named) {
            return atWaypoint(
                request, i, refuse(RefusalReason::unreachable, Errc::unreachable, toString(*miss)));
        }
        if (i == 0) {
            path = ToolPath(before, target);
        } else {
            const double radius = request.waypoints[i - 1].blend_radius;
            if (const auto checked = refuseCorner(path, before, target, radius); !checked) {
                return atWaypoint(request, i - 1, checked.error());
            }
            path.append(target, radius);
        }
        before = target;
    }
    return {};
}

Refusal onTheWay(Refusal refusal, const ToolPath& path, const PathRequest& request) {
    if (request.waypoints.size() > 1) {
        refusal.error.message =
            fmt::format("on the way to waypoint {}: {}", path.lineAt(refusal.fraction) + 1,
                        refusal.error.message);
    }
    return refusal;
}

}  // namespace metier::motion
