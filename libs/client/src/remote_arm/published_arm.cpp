#include "remote_arm/published_arm.hpp"

#include <fmt/format.h>

#include <utility>

#include "metier/device/joint_array.hpp"

namespace metier::client {
namespace {

Result<PublishedArm> checked(PublishedArm arm) {
    const auto& kinematics = arm.kinematics;
    if (kinematics.axisCount() > device::kMaxAxes || kinematics.cycle_time <= 0) {
        return fail(Errc::not_supported,
                    fmt::format("an arm of {} axes, at most {}; cycle {} s", kinematics.axisCount(),
                                device::kMaxAxes, kinematics.cycle_time));
    }
    return arm;
}

Result<PublishedArm> withKinematics(opcua::Client& client, KinematicsNodes nodes) {
    PublishedArm arm{.name = nodes.device_name, .kinematics = {}, .axis_names = {}};
    METIER_ASSIGN(arm.kinematics, readKinematics(client, nodes));
    for (std::size_t axis = 1; axis <= arm.kinematics.axisCount(); ++axis) {
        arm.axis_names.push_back(fmt::format("Axis {}", axis));
    }
    arm.nodes = std::move(nodes);
    return arm;
}

Result<PublishedArm> withAxes(opcua::Client& client, const SkillAddress& skill,
                              const GivenArm& given) {
    METIER_ASSIGN(auto robotics, findRoboticsArm(client, skill, given.device));
    AxisNames names{given.joint_names, {}, given.array_order};
    for (const auto& axis : robotics.axes) {
        names.axes.push_back(axis.name);
    }
    METIER_ASSIGN(auto places, placesOf(names));
    PublishedArm arm{robotics.name, given.kinematics, given.joint_names};
    arm.robotics = std::move(robotics);
    arm.places = std::move(places);
    return arm;
}

}  // namespace

std::vector<Lack> PublishedArm::lacks() const {
    if (nodes) {
        return {};
    }
    std::vector<Lack> lacks{Lack::measured_state};
    if (robotics.emergency_stops.empty() && robotics.protective_stops.empty()) {
        lacks.push_back(Lack::safety_state);
    }
    return lacks;
}

Result<PublishedArm> findArm(opcua::Client& client, const SkillAddress& skill,
                             const std::optional<GivenArm>& given) {
    auto nodes = findKinematics(client, skill);
    if (nodes) {
        return withKinematics(client, std::move(*nodes)).and_then(checked);
    }
    if (nodes.error().code != Errc::not_found) {
        return fail(std::move(nodes.error()));
    }
    if (!given) {
        return fail(Errc::not_found, nodes.error().message + ", and no model is given for it");
    }
    return withAxes(client, skill, *given).and_then(checked);
}

std::string changeOf(const PublishedArm& now, const PublishedArm& former, const std::string& url) {
    if (now.name != former.name) {
        return fmt::format("{} has another arm now, {}", url, now.name);
    }
    if (now.kinematics.axisCount() != former.kinematics.axisCount()) {
        return fmt::format("{} has another arm now, with {} axes instead of {}", url,
                           now.kinematics.axisCount(), former.kinematics.axisCount());
    }
    const bool same = now.kinematics == former.kinematics && now.places == former.places &&
                      now.nodes.has_value() == former.nodes.has_value();
    return same ? "" : fmt::format("{} publishes other kinematics or limits than before", url);
}

}  // namespace metier::client
