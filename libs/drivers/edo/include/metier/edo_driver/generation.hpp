#pragma once

#include <string_view>

#include "metier/base/error.hpp"

namespace metier::edo_driver {

/// Way in which set-points reach the joints; it changed between versions of the robot's software.
/// A value: the numbers are those of the services and topics of that software.
struct Generation {
    /// Message that carries set-points.
    enum class Kind : std::uint8_t {
        /// Up to 3.0.1: JointControlArray on /algo_jnt_ctrl.
        classic,
        /// From 3.1.2: JointValue on /external_control.
        external,
    };

    /// Message that carries set-points.
    Kind kind = Kind::classic;
    /// Mode of the service /algo_control_switch_srv that takes control.
    int take_mode = 1;
    /// Mode of the same service that gives control back.
    int give_back_mode = 2;
    /// Value of /algorithm_state while control is taken.
    int taken_state = 9;

    /// Whether that value shows that control is taken.
    bool isTaken(int algorithm_state) const noexcept { return algorithm_state == taken_state; }
    /// Topic of set-points.
    /// "/algo_jnt_ctrl" or "/external_control"; valid for ever, as is the type.
    std::string_view setPointTopic() const noexcept;
    /// ROS type of their messages.
    std::string_view setPointType() const noexcept;
};

/// Generation of software up to 3.0.1.
Generation classicGeneration() noexcept;
/// Generation of software from 3.1.2.
Generation externalGeneration() noexcept;

/// The generation of a software version, such as `edo_3.2.0` or `cube_2.4.0`.
/// Errors: not_supported if the version is not known.
/// Source: docs/protocols/edo.md#taking-control
Result<Generation> generationOf(std::string_view software);

}  // namespace metier::edo_driver
