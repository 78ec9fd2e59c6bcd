#include "described_model.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace metier::ur_driver {

using motion::ChainDescription;
using motion::Pose;
using motion::RobotModel;

namespace {

// The maker's presets allow 363 deg where the data sheet has 360, and 191 deg/s where it has 180.
constexpr double kPositionMargin = 0.0523;  // [rad]
constexpr double kVelocityShare = 180.0 / 191.0;
// A calibration moves the flange by millimetres, another size of arm by centimetres.
constexpr double kOtherArm = 0.03;  // [m]
constexpr double kSameArm = 1e-5;   // [m]
constexpr double kSameLimit = 1e-6;

Pose turnAboutZ(double angle) {
    return {Eigen::Vector3d::Zero(),
            Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()))};
}

/// Transform after joint i: Tz(d) Tx(a) Rx(alpha).
Pose afterJoint(const primary::Kinematics& dh, std::size_t i) {
    return {{dh.a[i], 0.0, dh.d[i]},
            Eigen::Quaterniond(Eigen::AngleAxisd(dh.alpha[i], Eigen::Vector3d::UnitX()))};
}

void calibrate(ChainDescription& chain, const primary::Kinematics& dh) {
    Pose before;
    for (std::size_t i = 0; i < kAxes; ++i) {
        chain.joints[i].parent_from_joint = before * turnAboutZ(dh.theta[i]);
        chain.joints[i].axis = Eigen::Vector3d::UnitZ();
        before = afterJoint(dh, i);
    }
    chain.last_from_flange = before;
}

void limit(ChainDescription& chain, const primary::Configuration& configuration) {
    for (std::size_t i = 0; i < kAxes; ++i) {
        auto& limits = chain.joints[i].limits;
        limits.lower = std::max(limits.lower, configuration.lower[i] + kPositionMargin);
        limits.upper = std::min(limits.upper, configuration.upper[i] - kPositionMargin);
        limits.velocity = std::min(limits.velocity, configuration.max_velocity[i] * kVelocityShare);
        limits.acceleration = std::min(limits.acceleration, configuration.max_acceleration[i]);
    }
}

/// Largest distance of the flanges over some positions of the arm [m].
double flangeDistance(const RobotModel& first, const RobotModel& second) {
    double largest = 0.0;
    for (const double offset : {0.0, 0.7, -1.1}) {
        auto q = first.home();
        q.view().array() += offset;
        largest = std::max(largest, motion::distanceBetween(first.kinematics().forward(q),
                                                            second.kinematics().forward(q)));
    }
    return largest;
}

}  // namespace

Result<RobotModel> describedModel(const RobotModel& file,
                                  const ControllerDescription& description) {
    if (file.axisCount() != kAxes) {
        return fail(Errc::invalid_argument, fmt::format("model {} has {} axes, a UR arm has {}",
                                                        file.name(), file.axisCount(), kAxes));
    }
    ChainDescription chain = file.chain();
    if (description.kinematics) {
        calibrate(chain, *description.kinematics);
    }
    if (description.configuration) {
        limit(chain, *description.configuration);
    }
    auto model = file.withChain(std::move(chain));
    if (!model) {
        return fail(Errc::invalid_argument,
                    "what the controller reports of its arm: " + model.error().message);
    }
    if (const double distance = flangeDistance(file, *model); !(distance < kOtherArm)) {
        return fail(Errc::invalid_argument,
                    fmt::format("the controller's flange is {:.3f} m away from that of model {}: "
                                "it has another arm",
                                distance, file.name()));
    }
    return model;
}

std::string differenceText(const RobotModel& used, const ControllerDescription& description) {
    const auto described = describedModel(used, description);
    if (!described) {
        return described.error().message;
    }
    if (const double distance = flangeDistance(used, *described); distance > kSameArm) {
        return fmt::format(
            "the controller's calibration moves the flange by {:.2f} mm against the model in use; "
            "start metier while the controller is on to use it",
            1e3 * distance);
    }
    for (std::size_t i = 0; i < kAxes; ++i) {
        const auto& ours = used.limits(i);
        const auto& theirs = described->limits(i);
        if (theirs.velocity < ours.velocity - kSameLimit ||
            theirs.acceleration < ours.acceleration - kSameLimit ||
            theirs.lower > ours.lower + kSameLimit || theirs.upper < ours.upper - kSameLimit) {
            return fmt::format(
                "axis {}: the controller's limits are stricter than those in use; start metier "
                "while the controller is on to use them",
                i + 1);
        }
    }
    return {};
}

}  // namespace metier::ur_driver
