#include <fmt/format.h>

#include <memory>

#include "command_context.hpp"
#include "joint_text.hpp"
#include "robot_argument.hpp"

namespace metier::app {
namespace {

struct FkOptions {
    std::string robot;
    std::vector<std::string> joints;
    std::string tool;
    bool json = false;
};

Result<Exit> runFk(const FkOptions& options) {
    METIER_ASSIGN(const auto model, asUsage(loadRobot(options.robot)));
    METIER_ASSIGN(const auto joints, parseJoints(model, options.joints, "joint position"));
    METIER_ASSIGN(const auto tool, asUsage(model.tool(options.tool)));
    const auto pose = model.kinematics().forward(joints) * tool.flange_from_tool;
    const bool within_limits = model.kinematics().withinLimits(joints);
    if (options.json) {
        nlohmann::ordered_json json{{"robot", model.name()},
                                    {"joint_position", toJson(joints)},
                                    {"within_limits", within_limits},
                                    {"frame", tool.name}};
        json.update(toJson(pose));
        fmt::print("{}\n", json.dump(2));
        return Exit::success;
    }
    fmt::print("{}{}", toText(pose), within_limits ? "" : "outside of the joint limits\n");
    return Exit::success;
}

}  // namespace

void addFk(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<FkOptions>();
    auto* command =
        app.add_subcommand("fk", "Forward kinematics: the pose of the flange in the base frame");
    command->footer(
        "Rotations a, b, c are about x, y, z: R = Rz(c) Ry(b) Rx(a). The joint limits are printed, "
        "not\n"
        "applied.");
    addRobot(*command, options->robot);
    command
        ->add_option("joints", options->joints, "Joint positions, axis 1 first [rad]: -1.57 0 ...")
        ->required();
    command->add_option("--tool", options->tool, "A tool frame of the model instead of the flange");
    command->add_flag("--json", options->json, "Print JSON, every number with all its digits");
    command->callback([options, &context] { context.exit = exitOf(runFk(*options)); });
}

}  // namespace metier::app
