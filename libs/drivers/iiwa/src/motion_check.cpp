#include "motion_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "metier/iiwa_driver/wire.hpp"
#include "metier/motion/frame.hpp"
#include "metier/motion/rotation.hpp"

namespace metier::iiwa_driver {

namespace {

// The cabinet knows the arm's calibration, the model only the data sheet.
constexpr double kSamePlace = 2e-3;      // [m]
constexpr double kSameRotation = 10e-3;  // [rad]
// Rounding of a target at the end of an axis' range [rad].
constexpr double kRounding = 1e-6;

Result<void> checkShare(double share, std::string_view what) {
    if (share > 0.0 && share <= 1.0) {
        return {};
    }
    return fail(Errc::invalid_argument, fmt::format("{} {}: must be over 0, up to 1", what, share));
}

Result<void> checkAmount(double value, std::string_view what) {
    if (value >= 0.0 && std::isfinite(value)) {
        return {};
    }
    return fail(Errc::invalid_argument, fmt::format("{} {}: must be 0 or more", what, value));
}

Result<void> checkForces(const std::optional<device::ForceCondition>& until) {
    if (!until) {
        return {};
    }
    for (const auto& limit : until->force) {
        METIER_TRY(checkAmount(limit.value_or(0.0), "force limit [N]"));
    }
    return {};
}

Result<void> checkJoints(const motion::RobotModel& model, const device::JointArray& target) {
    if (target.size() != kAxes) {
        return fail(Errc::invalid_argument,
                    fmt::format("a target of {} axes, the arm has {}", target.size(), kAxes));
    }
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        const auto& limits = model.limits(axis);
        const bool within =
            target[axis] >= limits.lower - kRounding && target[axis] <= limits.upper + kRounding;
        if (!within) {
            return fail(Errc::out_of_range,
                        fmt::format("axis {}: target {:.4f} rad outside {:.4f} to {:.4f} rad",
                                    axis + 1, target[axis], limits.lower, limits.upper));
        }
    }
    return {};
}

Result<void> checkFlange(const motion::RobotModel& model, const Frame& target) {
    for (const double value : {target.x, target.y, target.z, target.a, target.b, target.c}) {
        if (!std::isfinite(value)) {
            return fail(Errc::invalid_argument, "a target pose that is not finite");
        }
    }
    const auto miss = model.kinematics().outOfReach(motion::toPose(target), model.home());
    if (miss) {
        return fail(Errc::unreachable, motion::toString(*miss));
    }
    return {};
}

}  // namespace

Result<void> checkMotion(const motion::RobotModel& model,
                         const device::ControllerPlannedMotion& motion) {
    if (motion.path == device::ControllerPlannedMotion::Path::line && !motion.target_flange) {
        return fail(Errc::invalid_argument, "a line needs a pose as its target");
    }
    const auto target = motion.target_flange ? checkFlange(model, *motion.target_flange)
                                             : checkJoints(model, motion.target_joints);
    return target.and_then([&] { return checkShare(motion.velocity_share, "velocity share"); })
        .and_then([&] { return checkShare(motion.acceleration_share, "acceleration share"); })
        .and_then([&] { return checkAmount(motion.line_velocity, "velocity [m/s]"); })
        .and_then([&] { return checkAmount(motion.line_acceleration, "acceleration [m/s2]"); })
        .and_then([&] { return checkForces(motion.until); });
}

Result<void> checkSameFlange(const motion::Pose& by_model, const motion::Pose& by_cabinet) {
    const double distance = motion::distanceBetween(by_model, by_cabinet);
    const double angle = motion::rotationAngleBetween(by_model.rotation, by_cabinet.rotation);
    if (distance <= kSamePlace && angle <= kSameRotation) {
        return {};
    }
    return fail(Errc::device_fault,
                fmt::format("the cabinet sees the flange {:.4f} m and {:.4f} rad from where the "
                            "model does, limits {} m and {} rad: another arm, or a tool is "
                            "attached that the setting 'tool' does not name",
                            distance, angle, kSamePlace, kSameRotation));
}

}  // namespace metier::iiwa_driver
