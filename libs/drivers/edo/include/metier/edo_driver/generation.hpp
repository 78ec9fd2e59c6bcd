#pragma once

#include <string_view>

#include "metier/base/error.hpp"

namespace metier::edo_driver {

/// Way in which set-points reach the joints; it changed between versions of the robot's software.
struct Generation {
    enum class Kind : std::uint8_t {
        classic,   ///< up to 3.0.1: JointControlArray on /algo_jnt_ctrl
        external,  ///< from 3.1.2: JointValue on /external_control
    };

    Kind kind = Kind::classic;
    int take_mode = 1;       ///< mode of the service /algo_control_switch_srv that takes control
    int give_back_mode = 2;  ///< mode of the same service that gives control back
    int taken_state = 9;     ///< /algorithm_state while control is taken

    bool isTaken(int algorithm_state) const noexcept { return algorithm_state == taken_state; }
    std::string_view setPointTopic() const noexcept;
    std::string_view setPointType() const noexcept;
};

Generation classicGeneration() noexcept;
Generation externalGeneration() noexcept;

/// The generation of a software version, such as `edo_3.2.0` or `cube_2.4.0`.
/// Errors: not_supported if the version is not known.
/// Source: docs/protocols/edo.md#taking-control
Result<Generation> generationOf(std::string_view software);

}  // namespace metier::edo_driver
