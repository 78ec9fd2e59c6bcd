#include "singularity.hpp"

#include <algorithm>
#include <cmath>

namespace metier::motion {

namespace {

/// A step of the axes and what the flange does meanwhile [m] and [rad] in one number.
struct Step {
    JointVector axes;
    double axes_length = 0;
    double flange_length = 0;
};

Step stepFrom(const Kinematics& kinematics, const JointVector& from, const JointVector& to) {
    Step step{to};
    step.axes.view() -= from.view();
    JointVector middle = from;
    middle.view() += 0.5 * step.axes.view();
    step.axes_length = step.axes.view().norm();
    step.flange_length = (kinematics.jacobian(middle) * step.axes.view()).norm();
    return step;
}

std::size_t largest(const JointVector& values) {
    std::size_t axis = 0;
    for (std::size_t i = 1; i < values.size(); ++i) {
        axis = std::abs(values[i]) > std::abs(values[axis]) ? i : axis;
    }
    return axis;
}

/// \param text after "singularity: " and before the place
tl::unexpected<Refusal> singular(std::string_view text, std::size_t axis, double fraction) {
    Refusal refusal =
        refuse(RefusalReason::singularity, Errc::unreachable,
               fmt::format("singularity: {}, at {:.1f} % of the path", text, 100 * fraction), axis);
    refusal.fraction = fraction;
    return tl::unexpected(std::move(refusal));
}

}  // namespace

Checked refuseSingular(const RobotModel& model, const JointPath& path,
                       const PlannerOptions& options) {
    const std::vector<JointVector>& knots = path.knots();
    const Kinematics& kinematics = model.kinematics();
    const double limit = options.smallest_singular_value;
    const bool may_pass = options.singular_places == SingularPlaces::passed_where_axes_follow;
    const std::size_t last = knots.size() - 1;
    for (std::size_t k = 0; limit > 0 && k <= last; ++k) {
        const std::size_t from = std::min(k, last - 1);
        const Step step = stepFrom(kinematics, knots[from], knots[from + 1]);
        // The flange moves at least its smallest singular value per turn of the axes.
        if (may_pass && step.flange_length >= limit * step.axes_length) {
            continue;
        }
        const double value = kinematics.smallestSingularValue(knots[k]);
        if (value < limit) {
            const std::size_t axis = largest(step.axes);
            return singular(
                fmt::format("smallest singular value {:.5f}, limit {:.5f}, axis {} turns most",
                            value, limit, axis + 1),
                axis, path.places()[k]);
        }
    }
    return {};
}

Checked refuseCrawling(const RobotModel& model, const TrackedPath& path, double speed,
                       const PlannerOptions& options) {
    const SpeedBottleneck slowest = findBottleneck(model, path.bounds, speed);
    if (slowest.share >= options.slowest_share) {
        return {};
    }
    return singular(
        fmt::format("axis {} slows the path to {:.2f} % of the requested speed, limit {:.2f} %",
                    slowest.axis + 1, 100 * slowest.share, 100 * options.slowest_share),
        slowest.axis, path.joints.places()[slowest.knot]);
}

}  // namespace metier::motion
