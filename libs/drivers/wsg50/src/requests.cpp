#include "requests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace metier::wsg50_driver {
namespace {

struct Bounds {
    std::string_view what;
    std::string_view unit;
    double low;
    double high;
};

Result<void> check(double value, const Bounds& bounds) {
    if (value >= bounds.low && value <= bounds.high) {
        return {};
    }
    return fail(Errc::out_of_range,
                fmt::format("{} {} {} is not within {} to {} {}", bounds.what, value, bounds.unit,
                            bounds.low, bounds.high, bounds.unit));
}

double ownWidth(MotionKind kind, const Wsg50Options& options, const Limits& limits) {
    return kind == MotionKind::release ? options.open_width.value_or(limits.stroke)
                                       : options.part_width.value_or(0.0);
}

double ownForce(const Wsg50Options& options, const Known& known) {
    return options.force.value_or(
        std::clamp(known.force_limit, known.limits.min_force, known.limits.max_force));
}

}  // namespace

Result<Motion> motionFor(MotionKind kind, const device::GripperRequest& request,
                         const Wsg50Options& options, const Known& known) {
    const auto& limits = known.limits;
    if (kind == MotionKind::move && !request.width) {
        return fail(Errc::invalid_argument, "a move needs a width");
    }
    const double own_speed = kind == MotionKind::grasp ? options.grasp_speed : options.speed;
    const Motion motion{
        .kind = kind,
        .width = request.width.value_or(ownWidth(kind, options, limits)),
        .speed = request.speed.value_or(own_speed),
        .force = request.force.value_or(ownForce(options, known)),
        .any_width = !request.width && !options.part_width,
    };
    return check(motion.width, {"width", "m", 0.0, limits.stroke})
        .and_then([&] {
            return check(motion.speed, {"speed", "m/s", limits.min_speed, limits.max_speed});
        })
        .and_then([&] {
            return check(motion.force, {"force", "N", limits.min_force, limits.max_force});
        })
        .map([&] { return motion; });
}

}  // namespace metier::wsg50_driver
