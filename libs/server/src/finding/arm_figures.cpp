#include "finding/arm_figures.hpp"

#include <fmt/format.h>

#include <vector>

#include "metier/client/kinematics_reader.hpp"
#include "metier/server/kinematics_conversion.hpp"

namespace metier::server {
namespace {

std::optional<double> reachOf(const opcua_skill::KinematicsData& data) {
    std::vector<double> middle;
    for (std::size_t axis = 0; axis < data.axisCount(); ++axis) {
        middle.push_back((data.min_joint_position[axis] + data.max_joint_position[axis]) / 2);
    }
    auto chain = toChain(data, middle);
    if (!chain) {
        return std::nullopt;
    }
    const auto model = motion::RobotModel::fromChain(std::move(*chain));
    return model ? std::optional(model->kinematics().reach()) : std::nullopt;
}

}  // namespace

ArmFigures figuresOfArm(opcua::Client& client, const client::SkillAddress& skill) {
    const auto nodes = client::findKinematics(client, skill);
    if (!nodes) {
        return {};
    }
    const auto data = client::readKinematics(client, *nodes);
    if (!data) {
        return {};
    }
    return {reachOf(*data), data->payload > 0 ? std::optional(data->payload) : std::nullopt};
}

bool isAtLeast(const ArmFigures& wanted, const ArmFigures& there) {
    const auto enough = [](const std::optional<double>& least, const std::optional<double>& has) {
        return !least || (has && *has >= *least);
    };
    return enough(wanted.reach, there.reach) && enough(wanted.payload, there.payload);
}

std::string textOf(const ArmFigures& wanted) {
    const auto reach =
        wanted.reach ? fmt::format(" with a reach of {} m", *wanted.reach) : std::string();
    return wanted.payload ? fmt::format("{} {} a payload of {} kg", reach,
                                        wanted.reach ? "and" : "with", *wanted.payload)
                          : reach;
}

}  // namespace metier::server
