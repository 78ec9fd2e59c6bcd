#pragma once

#include <filesystem>

#include "metier/motion/robot_model.hpp"

namespace metier::virtual_iiwa {

inline const motion::RobotModel& iiwaModel() {
    static const auto kModel =
        motion::RobotModel::load(std::filesystem::path(METIER_MODELS_DIR) / "iiwa7.toml").value();
    return kModel;
}

}  // namespace metier::virtual_iiwa
