#include "metier/motion/robot_model.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace metier::motion {

namespace {

tl::unexpected<Error> invalid(const JointDescription& joint, std::size_t axis,
                              std::string_view what) {
    return fail(Errc::invalid_argument,
                fmt::format("axis {} ({}): {}", axis + 1, joint.name, what));
}

Result<void> checkLimits(const JointDescription& joint, std::size_t axis) {
    const JointLimits& limits = joint.limits;
    if (!std::isfinite(limits.lower) || !std::isfinite(limits.upper) ||
        limits.lower >= limits.upper) {
        return invalid(joint, axis,
                       fmt::format("position limits {} to {} rad", limits.lower, limits.upper));
    }
    for (const double limit : {limits.velocity, limits.acceleration, limits.jerk}) {
        if (!std::isfinite(limit) || limit <= 0) {
            return invalid(joint, axis,
                           fmt::format("a velocity, acceleration or jerk limit is {}", limit));
        }
    }
    return {};
}

bool isRigid(const Pose& pose) {
    return pose.translation.allFinite() && std::abs(pose.rotation.norm() - 1.0) < 1e-9;
}

Result<void> checkJoint(const JointDescription& joint, std::size_t axis) {
    if (!isRigid(joint.parent_from_joint)) {
        return invalid(joint, axis, "its frame is not a finite position and a unit quaternion");
    }
    if (!(std::abs(joint.axis.norm() - 1.0) < 1e-9)) {
        return invalid(joint, axis, "its turning axis is not a unit vector");
    }
    return checkLimits(joint, axis);
}

Result<void> checkHome(const ChainDescription& chain) {
    if (chain.home.size() != chain.joints.size()) {
        return fail(Errc::invalid_argument, fmt::format("home has {} values for {} axes",
                                                        chain.home.size(), chain.joints.size()));
    }
    for (std::size_t i = 0; i < chain.home.size(); ++i) {
        const JointLimits& limits = chain.joints[i].limits;
        if (!(chain.home[i] >= limits.lower && chain.home[i] <= limits.upper)) {
            return invalid(chain.joints[i], i,
                           fmt::format("home {} rad is outside {} to {} rad", chain.home[i],
                                       limits.lower, limits.upper));
        }
    }
    return {};
}

Result<void> checkRest(const ChainDescription& chain) {
    const CartesianLimits& c = chain.cartesian_limits;
    for (const double limit : {c.velocity, c.acceleration, c.jerk, c.angular_velocity,
                               c.angular_acceleration, c.angular_jerk, chain.cycle_time}) {
        if (!std::isfinite(limit) || limit <= 0) {
            return fail(Errc::invalid_argument,
                        fmt::format("a Cartesian limit or the cycle time is {}", limit));
        }
    }
    if (!isRigid(chain.last_from_flange)) {
        return fail(Errc::invalid_argument, "the flange frame is not a rigid transform");
    }
    for (const ToolFrame& tool : chain.tools) {
        if (!(tool.mass >= 0) || !std::isfinite(tool.mass) || !tool.centre_of_mass.allFinite()) {
            return fail(Errc::invalid_argument,
                        fmt::format("tool frame \"{}\": mass {} kg, or its centre of mass, is not "
                                    "a finite number >= 0",
                                    tool.name, tool.mass));
        }
        if (tool.name.empty() || tool.name == "flange" || !isRigid(tool.flange_from_tool)) {
            return fail(
                Errc::invalid_argument,
                fmt::format("tool frame \"{}\" has a reserved name or is not rigid", tool.name));
        }
    }
    return checkHome(chain);
}

Result<void> checkChain(const ChainDescription& chain) {
    if (chain.joints.empty() || chain.joints.size() > kMaxAxes) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} axes, not 1 to {}", chain.joints.size(), kMaxAxes));
    }
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
        METIER_TRY(checkJoint(chain.joints[i], i));
    }
    return checkRest(chain);
}

}  // namespace

RobotModel::RobotModel(ChainDescription chain) : chain_(std::move(chain)), kinematics_(chain_) {}

Result<RobotModel> RobotModel::fromChain(ChainDescription chain) {
    METIER_TRY(checkChain(chain));
    return RobotModel(std::move(chain));
}

Result<RobotModel> RobotModel::withChain(ChainDescription chain) const {
    if (chain.joints.size() != axisCount()) {
        return fail(Errc::invalid_argument, fmt::format("a chain of {} axes for {}, which has {}",
                                                        chain.joints.size(), name(), axisCount()));
    }
    auto changed = fromChain(std::move(chain));
    if (changed) {
        changed->appearance_ = appearance_;
    }
    return changed;
}

Result<ToolFrame> RobotModel::tool(std::string_view tool_name) const {
    if (tool_name.empty() || tool_name == "flange") {
        return ToolFrame{"flange", {}, 0, Eigen::Vector3d::Zero()};
    }
    std::string known = "flange";
    for (const ToolFrame& tool : chain_.tools) {
        if (tool.name == tool_name) {
            return tool;
        }
        known += ", " + tool.name;
    }
    return fail(Errc::not_found,
                fmt::format("no tool frame \"{}\"; there are: {}", tool_name, known));
}

}  // namespace metier::motion
