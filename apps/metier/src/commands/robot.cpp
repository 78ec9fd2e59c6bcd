#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "command_context.hpp"
#include "joint_text.hpp"
#include "metier/robot_files/export.hpp"
#include "metier/robot_files/import.hpp"
#include "printable.hpp"
#include "robot_argument.hpp"

namespace metier::app {
namespace {

namespace fs = std::filesystem;
using robot_files::ImportedRobot;
using robot_files::ImportOptions;
using robot_files::SourceFile;

/// What is written where.
struct OutputOptions {
    std::string file;
    bool force = false;
};

struct ImportArguments {
    std::string urdf;
    std::string srdf;
    OutputOptions output;
    ImportOptions options;
    double cycle_time = 0;
    /// Lists of numbers as they were given.
    std::string velocity;
    std::string acceleration;
    std::string jerk;
    std::string position;
    std::string home;
};

struct ExportArguments {
    std::string robot;
    std::string srdf;
    OutputOptions output;
};

Result<SourceFile> sourceFile(const std::string& name) {
    std::ifstream file(name, std::ios::binary);
    SourceFile source{name, {std::istreambuf_iterator<char>(file), {}}};
    if (!file.is_open() || file.bad()) {
        return fail(Errc::invalid_argument, fmt::format("{}: cannot be read", name));
    }
    return source;
}

Result<void> writeNew(const std::string& file, const std::string& text, bool force) {
    std::error_code error;
    if (!force && fs::exists(file, error)) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: exists; --force writes over it", file));
    }
    return writeFile(file, text);
}

Result<void> readList(const std::string& text, const char* what, std::vector<double>& values) {
    if (!text.empty()) {
        METIER_ASSIGN(values, parseNumbers({{text}}, what));
    }
    return {};
}

Result<void> readLists(ImportArguments& arguments) {
    auto& options = arguments.options;
    METIER_TRY(readList(arguments.velocity, "velocity", options.velocity));
    METIER_TRY(readList(arguments.acceleration, "acceleration", options.acceleration));
    METIER_TRY(readList(arguments.jerk, "jerk", options.jerk));
    METIER_TRY(readList(arguments.position, "position", options.position));
    METIER_TRY(readList(arguments.home, "home", options.home));
    if (arguments.cycle_time != 0) {
        options.cycle_time = arguments.cycle_time;
    }
    return {};
}

/// Prints sentences below a heading, if there are any.
void printList(std::FILE* out, const char* heading, const std::vector<std::string>& texts) {
    if (!texts.empty()) {
        fmt::print(out, "{}\n", heading);
    }
    for (const auto& text : texts) {
        fmt::print(out, "  - {}\n", printable(text));
    }
}

void printImported(std::FILE* out, const ImportedRobot& robot) {
    fmt::print(out, "{}: {}\n", printable(std::string(robot.model.name())), printable(robot.chain));
    fmt::print(out, "planning: {}\n", robot.planning);
    printList(out, "assumed, since nothing gives it; check it before an arm moves:", robot.assumed);
    printList(out, "left out:", robot.left_out);
    printList(out, "besides:", robot.remarks);
}

Result<Exit> runImport(ImportArguments arguments) {
    METIER_TRY(readLists(arguments));
    METIER_ASSIGN(const auto urdf, sourceFile(arguments.urdf));
    std::optional<SourceFile> srdf;
    if (!arguments.srdf.empty()) {
        METIER_ASSIGN(srdf, sourceFile(arguments.srdf));
    }
    METIER_ASSIGN(const auto robot, robot_files::importUrdf(urdf, srdf, arguments.options));
    if (arguments.output.file == "-") {
        fmt::print("{}", robot.text);
        printImported(stderr, robot);
        return Exit::success;
    }
    METIER_TRY(writeNew(arguments.output.file, robot.text, arguments.output.force));
    printImported(stdout, robot);
    return Exit::success;
}

Result<Exit> runExport(const ExportArguments& arguments) {
    METIER_ASSIGN(const auto model, asUsage(loadRobot(arguments.robot)));
    const auto exported = robot_files::exportUrdf(model);
    if (!arguments.srdf.empty()) {
        METIER_TRY(writeNew(arguments.srdf, exported.srdf, arguments.output.force));
    }
    if (arguments.output.file == "-") {
        fmt::print("{}", exported.urdf);
        printList(stderr, "left out:", exported.left_out);
        return Exit::success;
    }
    METIER_TRY(writeNew(arguments.output.file, exported.urdf, arguments.output.force));
    printList(stdout, "left out:", exported.left_out);
    return Exit::success;
}

void addOutput(CLI::App& command, OutputOptions& output, const char* what) {
    output.file = "-";
    command.add_option("-o,--output", output.file, what)->capture_default_str();
    command.add_flag("--force", output.force, "Write over files that exist");
}

void addLimits(CLI::App& command, ImportArguments& arguments) {
    const auto list = [&](const char* name, std::string& value, const char* about) {
        command.add_option(name, value, about)->type_name("x or x1,x2,...");
    };
    list("--velocity", arguments.velocity, "Velocity limits of axes without one [rad/s]");
    list("--acceleration", arguments.acceleration,
         "Acceleration limits of axes without one [rad/s2]; without it 5");
    list("--jerk", arguments.jerk, "Jerk limits of axes without one [rad/s3]; without it 50");
    command
        .add_option("--position", arguments.position,
                    "Range of axes without one [rad]; of continuous ones without it -2 pi to 2 pi")
        ->type_name("lower,upper");
    command
        .add_option("--home", arguments.home,
                    "A usable working position [rad]; without it the SRDF file's group_state "
                    "\"home\", else one that is searched")
        ->type_name("q1,q2,...");
    command
        .add_option("--cycle-time", arguments.cycle_time,
                    "Period of the controller [s]; without it 0.008")
        ->check(CLI::Range(1e-4, 1.0));
}

void addImport(CLI::App& robot, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto arguments = std::make_shared<ImportArguments>();
    auto* command = robot.add_subcommand("import", "Make a robot model from a URDF file");
    command->footer(
        "Prints what is assumed and left out, and which moves can be planned with the chain; what\n"
        "cannot be taken in is refused with file, line and element. A xacro file has to be\n"
        "expanded first: xacro FILE > FILE.urdf. See docs/guide/robot-files.md.");
    auto& options = arguments->options;
    command->add_option("urdf", arguments->urdf, "URDF file")->required();
    command->add_option("--srdf", arguments->srdf,
                        "SRDF file: chain, home position, pairs of links that are not compared");
    addOutput(*command, arguments->output, "Model file to write; -: standard output");
    command->add_option("--base", options.base,
                        "Link whose frame becomes the base frame; without it the first link");
    command->add_option(
        "--tip", options.tip,
        "Link whose frame becomes the flange; without it the end of the only chain");
    command->add_option("--group", options.group,
                        "Group of the SRDF file that gives base and tip; without it the only one");
    command->add_option("--name", options.name, "Name of the model; without it the file's");
    command->add_option("--maker", options.maker, "Name of the maker");
    command->add_option("--product", options.product, "Name of the product");
    addLimits(*command, *arguments);
    command->add_flag("--round-angles", options.round_angles,
                      "Take angles of frames within 1e-4 rad of a multiple of 15 degrees for it: "
                      "1.5708 is meant to be a right angle");
    command->callback([arguments, &context] { context.exit = exitOf(runImport(*arguments)); });
}

void addExport(CLI::App& robot, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto arguments = std::make_shared<ExportArguments>();
    auto* command = robot.add_subcommand("export", "Write a robot model as a URDF file");
    addRobot(*command, arguments->robot);
    addOutput(*command, arguments->output, "URDF file to write; -: standard output");
    command->add_option("--srdf", arguments->srdf,
                        "SRDF file to write: home position, pairs of links that are not compared");
    command->callback([arguments, &context] { context.exit = exitOf(runExport(*arguments)); });
}

}  // namespace

void addRobotFiles(CLI::App& app, CommandContext& context) {
    auto* robot = app.add_subcommand("robot", "Import and export robot models as URDF files");
    robot->require_subcommand(1);
    addImport(*robot, context);
    addExport(*robot, context);
}

}  // namespace metier::app
