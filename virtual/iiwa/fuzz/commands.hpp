#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "robot_application.hpp"

/// Common parts of the cabinet's fuzz targets: an arm, and commands read from an input.
namespace metier::virtual_iiwa {

inline Cabinet cabinet() {
    static const auto kModel =
        motion::RobotModel::load(std::filesystem::path(METIER_MODELS_DIR) / "iiwa7.toml").value();
    return {.arm = Arm(kModel, kModel.home()), .torque_noise = motion::JointVector(7)};
}

/// Every second command gets a code that exists, so that the arguments behind it are reached.
inline Command commandOf(std::span<const std::uint8_t> input, Precision precision) {
    auto command = decodeCommand(std::as_bytes(input), precision);
    if (input[0] % 2 == 0) {
        constexpr std::array kFirst{101.0, 201.0, 211.0, 221.0, 301.0, 400.0};
        command.code = kFirst[input[1] % kFirst.size()] + double(input[1] >> 5U);
    }
    return command;
}

}  // namespace metier::virtual_iiwa
