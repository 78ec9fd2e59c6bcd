#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>

#include "metier/motion/robot_model.hpp"

namespace metier::motion {

inline const std::array<std::string, 5> kRobots{"ur5", "ur5e", "iiwa7", "iiwa14", "edo"};

inline RobotModel loadRobot(const std::string& name) {
    auto model = RobotModel::load(std::string(METIER_MODELS_DIR) + "/" + name + ".toml");
    if (!model) {
        throw std::runtime_error(model.error().message);
    }
    return std::move(*model);
}

/// A number of random cases: more of them with METIER_TEST_SCALE in the environment.
inline int scaled(int count) {
    const char* scale = std::getenv("METIER_TEST_SCALE");
    return scale == nullptr ? count : count * std::max(1, std::atoi(scale));
}

/// A joint position inside the limits (and one turn), the same on every run.
inline JointVector randomPosition(const RobotModel& model, std::mt19937_64& random) {
    JointVector q(model.axisCount());
    for (std::size_t i = 0; i < q.size(); ++i) {
        const double lower = std::max(model.limits(i).lower, -std::numbers::pi);
        const double upper = std::min(model.limits(i).upper, std::numbers::pi);
        q[i] = std::uniform_real_distribution<double>(lower, upper)(random);
    }
    return q;
}

/// Largest difference of position [m] and rotation [rad].
double poseError(const motion::Pose& a, const motion::Pose& b);

class EachRobot : public testing::TestWithParam<std::string> {
protected:
    RobotModel model_ = loadRobot(GetParam());
    const Kinematics& kinematics_ = model_.kinematics();
};

inline std::string robotName(const testing::TestParamInfo<std::string>& info) {
    return info.param;
}

}  // namespace metier::motion
