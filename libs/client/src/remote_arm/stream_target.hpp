#pragma once

#include <functional>
#include <string>
#include <vector>

#include "metier/client/skill_finder.hpp"
#include "metier/device/joint_array.hpp"
#include "metier/opcua/client.hpp"
#include "metier/skill/value.hpp"
#include "program_state.hpp"
#include "remote_arm/axis_order.hpp"

namespace metier::client {

/// The live parameter of a position stream, and how a set-point is written to it.
struct StreamTarget {
    std::string parameter = "TargetJointPosition";
    double radians_per_unit = 1.0;     ///< of joint positions
    std::vector<JointPlace> places{};  ///< of each joint; empty: all in order
    /// base_from_flange at joint positions; for a stream of poses.
    std::function<skill::Frame(const device::JointArray&)> pose_at{};

    /// Value of the parameter for a set-point [rad], axis 1 first.
    skill::Value valueOf(const device::JointArray& set_point) const;
};

/// A position stream of another maker.
struct ForeignStream {
    StreamTarget target;
    ProgramNodes program;  ///< state of the skill
};

/// Finds the nodes of a position stream: TargetJointPosition, or else TargetPosition.
/// \param preset places, and the function for poses
/// Errors: not_found, if it has neither, or only TargetPosition and no function for poses;
///         not_supported for a skill without Halt or Reset, whose stream could not be ended;
///         those of the server. Threads: any but the client's own; waits.
opcua::Answer<ForeignStream> findForeignStream(opcua::Client& client, const SkillAddress& skill,
                                               StreamTarget preset);

}  // namespace metier::client
