#include "arm_figures.hpp"

#include <vector>

#include "kinematics_conversion.hpp"
#include "metier/skill_client/kinematics_reader.hpp"

namespace metier::app {
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

ArmFigures figuresOfArm(opcua::Client& client, const skill_client::SkillAddress& skill) {
    const auto nodes = skill_client::findKinematics(client, skill);
    if (!nodes) {
        return {};
    }
    const auto data = skill_client::readKinematics(client, *nodes);
    if (!data) {
        return {};
    }
    return {reachOf(*data), data->payload > 0 ? std::optional(data->payload) : std::nullopt};
}

}  // namespace metier::app
