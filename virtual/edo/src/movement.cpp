#include "movement.hpp"

#include <cmath>

namespace metier::virtual_edo {
namespace {

// Below this sine of e only the sum of a and r is defined.
constexpr double kAligned = 4e-4;

Point pointFrom(const Json& message) {
    Point point{.data_type = message["data_type"].get<std::uint8_t>(),
                .pose = cartesianFrom(message["cartesian_data"]),
                .joints_mask = message["joints_mask"].get<std::uint64_t>(),
                .joints = {}};
    for (const auto& value : message["joints_data"]) {
        point.joints.push_back(value.get<double>());
    }
    return point;
}

}  // namespace

CartesianPose cartesianFrom(const Json& message) {
    return {.x = message["x"].get<double>(),
            .y = message["y"].get<double>(),
            .z = message["z"].get<double>(),
            .a = message["a"].get<double>(),
            .e = message["e"].get<double>(),
            .r = message["r"].get<double>()};
}

Json toJson(const CartesianPose& pose) {
    return {{"x", finiteOrNull(pose.x)}, {"y", finiteOrNull(pose.y)}, {"z", finiteOrNull(pose.z)},
            {"a", finiteOrNull(pose.a)}, {"e", finiteOrNull(pose.e)}, {"r", finiteOrNull(pose.r)},
            {"config_flags", ""}};
}

motion::Pose toPose(const CartesianPose& wire) {
    using Eigen::AngleAxisd;
    return {.translation = Eigen::Vector3d(wire.x, wire.y, wire.z) / 1000.0,
            .rotation = Eigen::Quaterniond(AngleAxisd(wire.a * kDegree, Eigen::Vector3d::UnitZ()) *
                                           AngleAxisd(wire.e * kDegree, Eigen::Vector3d::UnitY()) *
                                           AngleAxisd(wire.r * kDegree, Eigen::Vector3d::UnitZ()))};
}

CartesianPose toCartesian(const motion::Pose& pose) {
    const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
    const double sine = std::hypot(rotation(0, 2), rotation(1, 2));
    double a = 0.0;
    double r = std::atan2(rotation(1, 0), rotation(1, 1));
    if (sine > kAligned) {
        a = std::atan2(rotation(1, 2), rotation(0, 2));
        r = std::atan2(rotation(2, 1), -rotation(2, 0));
    }
    return {.x = pose.translation.x() * 1000.0,
            .y = pose.translation.y() * 1000.0,
            .z = pose.translation.z() * 1000.0,
            .a = a / kDegree,
            .e = std::atan2(sine, rotation(2, 2)) / kDegree,
            .r = r / kDegree};
}

Movement Movement::from(const Json& message) {
    return {.command = message["move_command"].get<std::uint8_t>(),
            .type = message["move_type"].get<std::uint8_t>(),
            .override_percent = message["ovr"].get<std::uint8_t>(),
            .delay = message["delay"].get<std::uint8_t>(),
            .target = pointFrom(message["target"]),
            .via = pointFrom(message["via"]),
            .tool = cartesianFrom(message["tool"]),
            .frame = cartesianFrom(message["frame"])};
}

}  // namespace metier::virtual_edo
