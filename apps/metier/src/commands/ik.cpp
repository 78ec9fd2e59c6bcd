#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "command_context.hpp"
#include "joint_text.hpp"
#include "metier/motion/rotation.hpp"
#include "robot_argument.hpp"

namespace metier::app {
namespace {

using motion::IkKind;
using motion::JointVector;
using motion::Pose;
using motion::RobotModel;

struct IkOptions {
    std::string robot;
    std::vector<std::string> pose;
    std::string tool;
    std::string reference;
    std::string arm_angle;
    bool json = false;
};

/// Question read from the command line.
struct IkQuestion {
    RobotModel model;
    motion::ToolFrame tool;
    Pose base_from_tool;
    JointVector reference;
    std::optional<double> arm_angle;  ///< only for a 7-axis arm

    Pose flange() const { return base_from_tool * tool.flange_from_tool.inverse(); }
};

/// One joint position that reaches the pose, and how well.
struct Solution {
    JointVector joints;
    bool within_limits = false;
    double position_residual = 0;  ///< [m]
    double rotation_residual = 0;  ///< [rad]
};

/// Without --reference: all 0; home for a chain that is solved by iteration from there.
Result<JointVector> referenceOf(const IkOptions& options, const RobotModel& model) {
    if (!options.reference.empty()) {
        return parseJoints(model, {{options.reference}}, "reference");
    }
    return model.kinematics().ikKind() == IkKind::numeric ? model.home()
                                                          : JointVector(model.axisCount());
}

/// Without --arm-angle: that of the reference, if one was given; else 0.
Result<std::optional<double>> armAngleOf(const IkOptions& options, const RobotModel& model,
                                         const JointVector& reference) {
    const bool redundant = model.kinematics().ikKind() == IkKind::arm_angle;
    if (options.arm_angle.empty()) {
        const double angle =
            options.reference.empty() ? 0.0 : model.kinematics().redundancyAngle(reference);
        return redundant ? std::optional(angle) : std::nullopt;
    }
    METIER_ASSIGN(const auto angle, parseNumbers({{options.arm_angle}}, "arm angle"));
    if (!redundant || angle.size() != 1) {
        return fail(Errc::invalid_argument,
                    redundant ? fmt::format("arm angle: {} values given, it is one", angle.size())
                              : fmt::format("{} has no arm angle: only seven-axis arms have",
                                            model.name()));
    }
    return angle.front();
}

Result<IkQuestion> questionOf(const IkOptions& options) {
    METIER_ASSIGN(auto model, loadRobot(options.robot));
    METIER_ASSIGN(const auto pose, parsePose(options.pose, "pose"));
    METIER_ASSIGN(auto tool, model.tool(options.tool));
    METIER_ASSIGN(const auto reference, referenceOf(options, model));
    METIER_ASSIGN(const auto arm_angle, armAngleOf(options, model, reference));
    return IkQuestion{std::move(model), std::move(tool), pose, reference, arm_angle};
}

/// Turns each axis that is outside of its limits by a whole turn, if that brings it inside.
JointVector turnedIntoLimits(const RobotModel& model, JointVector joints) {
    constexpr double turn = 2 * std::numbers::pi;
    for (std::size_t axis = 0; axis < joints.size(); ++axis) {
        const auto& limits = model.limits(axis);
        for (const double turned : {joints[axis] + turn, joints[axis] - turn}) {
            const bool outside = joints[axis] < limits.lower || joints[axis] > limits.upper;
            if (outside && turned >= limits.lower && turned <= limits.upper) {
                joints[axis] = turned;
            }
        }
    }
    return joints;
}

/// Whether two joint positions are one, but for whole turns and rounding: in a singularity two
/// branches meet, and rounding tears them apart by the square root of its size.
bool same(const JointVector& a, const JointVector& b) {
    constexpr double near = 1e-6;  // [rad]
    return std::equal(a.begin(), a.end(), b.begin(), [](double one, double other) {
        return !(std::abs(std::remainder(one - other, 2 * std::numbers::pi)) > near);
    });
}

std::vector<Solution> solve(const IkQuestion& question) {
    const auto& arm = question.model.kinematics();
    const auto target = question.flange();
    const auto found = arm.allSolutions(target, question.reference, question.arm_angle);
    std::vector<Solution> solutions;
    for (const auto& joints : found) {
        const bool known =
            std::any_of(solutions.begin(), solutions.end(),
                        [&](const Solution& other) { return same(other.joints, joints); });
        if (known) {
            continue;
        }
        const auto turned = turnedIntoLimits(question.model, joints);
        const auto reached = arm.forward(turned);
        solutions.push_back({turned, arm.withinLimits(turned),
                             motion::distanceBetween(reached, target),
                             motion::rotationAngleBetween(reached.rotation, target.rotation)});
    }
    return solutions;
}

/// Why there is no solution, with distance and reach.
std::string whyNone(const IkQuestion& question) {
    const auto nearest = question.model.kinematics().inverse(
        question.flange(), {question.reference, {}, question.arm_angle});
    return nearest ? "unreachable at this arm angle" : nearest.error().message;
}

nlohmann::ordered_json jsonOf(const IkQuestion& question, const std::vector<Solution>& solutions) {
    nlohmann::ordered_json json{{"robot", question.model.name()}, {"frame", question.tool.name}};
    json.update(toJson(question.base_from_tool));
    if (question.arm_angle) {
        json["arm_angle"] = *question.arm_angle;
    }
    json["solutions"] = nlohmann::ordered_json::array();
    for (const auto& solution : solutions) {
        json["solutions"].push_back({{"joint_position", toJson(solution.joints)},
                                     {"within_limits", solution.within_limits},
                                     {"position_residual", solution.position_residual},
                                     {"rotation_residual", solution.rotation_residual}});
    }
    return json;
}

void printTable(const IkQuestion& question, const std::vector<Solution>& solutions) {
    fmt::print(
        "{} solution{}{}\n", solutions.size(), solutions.size() == 1 ? "" : "s",
        question.arm_angle ? fmt::format(" at arm angle {:.6f} rad", *question.arm_angle) : "");
    for (const auto& joint : question.model.chain().joints) {
        fmt::print("{:>14}", joint.name);
    }
    fmt::print("  limits    residual/m  residual/rad\n");
    for (const auto& solution : solutions) {
        for (const double value : solution.joints) {
            fmt::print("{:>14.9f}", std::abs(value) < 5e-10 ? 0.0 : value);
        }
        fmt::print("  {:<7} {:>12.1e} {:>13.1e}\n", solution.within_limits ? "within" : "outside",
                   solution.position_residual, solution.rotation_residual);
    }
}

Result<Exit> runIk(const IkOptions& options) {
    METIER_ASSIGN(const auto question, asUsage(questionOf(options)));
    const auto solutions = solve(question);
    auto json = jsonOf(question, solutions);
    auto exit = Exit::success;
    if (solutions.empty()) {
        exit = report({Errc::unreachable, whyNone(question)});
        json["error"] = whyNone(question);
    }
    if (options.json) {
        fmt::print("{}\n", json.dump(2));
    } else if (!solutions.empty()) {
        printTable(question, solutions);
    }
    return exit;
}

}  // namespace

void addIk(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<IkOptions>();
    auto* command = app.add_subcommand(
        "ik", "Inverse kinematics: all joint positions that put the flange at a pose");
    command->footer(
        "The pose is that of the flange in the base frame; R = Rz(c) Ry(b) Rx(a).\n"
        "Each axis is in (-pi, pi], or a whole turn off where only that is within its limits.\n"
        "Solutions outside of the limits are shown and marked; those within 1e-6 rad of another\n"
        "are one. Of a seven-axis arm: all branches at one arm angle. Of a chain without closed\n"
        "form: the one found from the reference. No solution at all: exit status 1.");
    addRobot(*command, options->robot);
    command->add_option("pose", options->pose, "x y z [m] and a b c [rad]: 0.4 -0.1 0.3 3.14 0 0")
        ->required();
    command->add_option("--tool", options->tool, "A tool frame of the model instead of the flange");
    command
        ->add_option("--arm-angle", options->arm_angle,
                     "Angle of a seven-axis arm's elbow about the line from shoulder to wrist, 0: "
                     "straight above it [rad]; without it that of --reference, else 0")
        ->type_name("FLOAT");
    command
        ->add_option("--reference", options->reference,
                     "Joint positions: where the pose leaves an axis free it stays as here [rad]; "
                     "without it all 0 (home for a chain without closed form)")
        ->type_name("q1,q2,...");
    command->add_flag("--json", options->json, "Print JSON, every number with all its digits");
    command->callback([options, &context] { context.exit = exitOf(runIk(*options)); });
}

}  // namespace metier::app
