#include "joint_rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>

namespace metier::robot_files {

namespace {

constexpr double kAcceleration = 5.0;  // [rad/s2]
constexpr double kJerk = 50.0;         // [rad/s3]
constexpr double kTurn = 2 * std::numbers::pi;

/// Names of the axes for which a value was assumed.
struct Assumed {
    std::vector<std::string> range;
    std::vector<std::string> acceleration;
    std::vector<std::string> jerk;
};

/// The value of an option for an axis; nothing if it was not given.
std::optional<double> optionFor(const std::vector<double>& values, std::size_t axis) {
    if (values.empty()) {
        return std::nullopt;
    }
    return values.size() == 1 ? values.front() : values[axis];
}

class LimitReader {
public:
    LimitReader(XmlFile& file, const ImportOptions& options) : file_(file), options_(options) {}

    motion::JointLimits read(const TreeJoint& joint, std::size_t axis);
    const Assumed& assumed() const { return assumed_; }

private:
    void readRange(const TreeJoint& joint, motion::JointLimits& limits);
    void narrow(const TreeJoint& joint, motion::JointLimits& limits);
    std::optional<double> positive(const TreeJoint& joint, const char* attribute);
    double velocity(const TreeJoint& joint, std::size_t axis);

    XmlFile& file_;
    const ImportOptions& options_;
    Assumed assumed_;
};

std::optional<double> LimitReader::positive(const TreeJoint& joint, const char* attribute) {
    const auto value = file_.number(joint.element.child("limit"), attribute);
    return value && *value > 0.0 ? value : std::nullopt;
}

double LimitReader::velocity(const TreeJoint& joint, std::size_t axis) {
    if (const auto given = positive(joint, "velocity")) {
        return *given;
    }
    if (const auto option = optionFor(options_.velocity, axis)) {
        return *option;
    }
    const auto limit = joint.element.child("limit");
    file_.note(
        limit ? limit : joint.element,
        fmt::format("joint \"{}\" has no velocity limit over 0: --velocity gives one [rad/s]",
                    joint.name));
    return 1.0;
}

/// The soft limits of a <safety_controller>, where they are narrower.
void LimitReader::narrow(const TreeJoint& joint, motion::JointLimits& limits) {
    const auto safety = joint.element.child("safety_controller");
    const auto lower = file_.number(safety, "soft_lower_limit");
    const auto upper = file_.number(safety, "soft_upper_limit");
    if (lower && upper && *lower < *upper) {
        limits.lower = std::max(limits.lower, *lower);
        limits.upper = std::min(limits.upper, *upper);
    }
}

void LimitReader::readRange(const TreeJoint& joint, motion::JointLimits& limits) {
    const auto limit = joint.element.child("limit");
    limits.lower = file_.number(limit, "lower").value_or(0.0);
    limits.upper = file_.number(limit, "upper").value_or(0.0);
    const bool endless = joint.type == "continuous";
    if (!endless && limits.lower < limits.upper) {
        narrow(joint, limits);
        if (limits.lower < limits.upper) {
            return;
        }
    }
    if (!options_.position.empty()) {
        limits.lower = options_.position[0];
        limits.upper = options_.position[1];
    } else if (endless) {
        limits.lower = -kTurn;
        limits.upper = kTurn;
        assumed_.range.push_back(joint.name);
    } else {
        file_.note(limit ? limit : joint.element,
                   fmt::format("joint \"{}\" has no range (lower {}, upper {}): --position gives "
                               "one [rad]",
                               joint.name, limits.lower, limits.upper));
        limits = {.lower = -1, .upper = 1};
    }
}

motion::JointLimits LimitReader::read(const TreeJoint& joint, std::size_t axis) {
    motion::JointLimits limits;
    readRange(joint, limits);
    limits.velocity = velocity(joint, axis);
    const auto other = [&](const char* attribute, const std::vector<double>& option,
                           double otherwise, std::vector<std::string>& assumed) {
        if (const auto given = positive(joint, attribute)) {
            return *given;
        }
        if (const auto value = optionFor(option, axis)) {
            return *value;
        }
        assumed.push_back(joint.name);
        return otherwise;
    };
    limits.acceleration =
        other("acceleration", options_.acceleration, kAcceleration, assumed_.acceleration);
    limits.jerk = other("jerk", options_.jerk, kJerk, assumed_.jerk);
    return limits;
}

/// A line about values that were assumed, if any was.
void tell(const std::vector<std::string>& joints, std::size_t all, const std::string& what,
          std::vector<std::string>& lines) {
    if (!joints.empty()) {
        lines.push_back(fmt::format("{} of {}", what,
                                    joints.size() == all
                                        ? std::string("every axis")
                                        : fmt::format("{}", fmt::join(joints, ", "))));
    }
}

}  // namespace

std::vector<motion::JointDescription> readAxes(const ChosenChain& chain,
                                               const ImportOptions& options,
                                               std::vector<std::string>& assumed) {
    const auto& [file, tree, choice] = chain;
    LimitReader limits(file, options);
    std::vector<motion::JointDescription> axes;
    for (std::size_t i = 0; i < choice.axes.size(); ++i) {
        const auto& joint = tree.joints()[choice.axes[i]];
        motion::JointDescription axis;
        axis.name = joint.name;
        axis.limits = limits.read(joint, i);
        axes.push_back(axis);
    }
    const auto& values = limits.assumed();
    tell(values.range, axes.size(), "range of -2 pi to 2 pi", assumed);
    tell(values.acceleration, axes.size(), fmt::format("acceleration of {} rad/s2", kAcceleration),
         assumed);
    tell(values.jerk, axes.size(), fmt::format("jerk of {} rad/s3", kJerk), assumed);
    return axes;
}

ChainFrames readFrames(const ChosenChain& chain, Angles angles) {
    const auto& [file, tree, choice] = chain;
    constexpr double shortest = 1e-6;
    ChainFrames frames;
    motion::Pose pose;
    for (const auto index : choice.joints) {
        const auto& joint = tree.joints()[index];
        pose = pose * file.origin(joint.element, angles == Angles::rounded);
        if (joint.isFixed()) {
            continue;
        }
        const auto element = joint.element.child("axis");
        const Eigen::Vector3d axis = file.vector(element, "xyz", Eigen::Vector3d::UnitX());
        if (axis.norm() < shortest) {
            file.note(element,
                      fmt::format("the axis of joint \"{}\" has no direction", joint.name));
        }
        frames.parent_from_joint.push_back(pose);
        frames.axis.push_back(axis.norm() < shortest ? Eigen::Vector3d::UnitX()
                                                     : axis.normalized());
        pose = {};
    }
    frames.last_from_flange = pose;
    return frames;
}

}  // namespace metier::robot_files
