#include <fmt/format.h>

#include <memory>

#include "command_context.hpp"
#include "joint_text.hpp"
#include "motion_picture.hpp"
#include "planned_move.hpp"
#include "robot_argument.hpp"

namespace metier::app {
namespace {

using motion::RobotModel;

/// Enough for a curve of 560 px, whatever bends it has.
constexpr std::size_t kSamples = 1501;

struct PlotOptions {
    MoveOptions move;
    std::string record;
    std::string records;
    std::string robot;  // robot of a recorded execution
    std::string title;
    std::string svg = "motion.svg";
};

/// The tool frame's speed that a linear move was asked for [m/s].
std::optional<double> askedSpeed(const RobotModel& model, const MoveOptions& options) {
    if (!options.linear) {
        return std::nullopt;
    }
    const auto values = parseNumbers({{options.max_velocity}}, "maximum");
    const double asked = values ? values->front() : 0.0;
    const double own = model.cartesianLimits().velocity;
    return options.speed_override * (asked > 0 ? std::min(asked, own) : own);
}

Result<DrawnMotion> plannedMotion(const RobotModel& model, const MoveOptions& options) {
    METIER_ASSIGN(const auto move, planMove(model, options));
    if (!move.plan) {
        return fail(Errc::unreachable, move.plan.error().error.message);
    }
    DrawnMotion motion;
    motion.samples = path_evaluation::sampleMotion(*move.plan, kSamples);
    for (const auto& sample : motion.samples) {
        motion.tool_positions.push_back(move.plan->toolPose(sample.position).translation);
    }
    motion.note = fmt::format("{}, {:.3f} s", move.skill, move.plan->duration().count());
    if (move.plan->length() > 0) {
        motion.note += fmt::format(", {:.4f} m", move.plan->length());
    }
    motion.asked_speed = askedSpeed(model, options);
    return motion;
}

Result<DrawnMotion> motionOf(const RobotModel& model, const PlotOptions& options) {
    if (options.record.empty()) {
        return plannedMotion(model, options.move);
    }
    if (hasTarget(options.move)) {
        return fail(Errc::invalid_argument, "--record and a target exclude each other");
    }
    METIER_ASSIGN(const auto record, asUsage(path_evaluation::loadRecord(options.record)));
    return recordedMotion(model, record, options.record, options.move.tool);
}

bool isNumber(const std::string& text) {
    return text.find_first_not_of("0123456789") == std::string::npos;
}

/// Whether the argument names an execution: it is no robot, and nothing says how one should move.
bool namesExecution(const PlotOptions& options) {
    if (!options.record.empty() || hasTarget(options.move) || isRobot(options.move.robot)) {
        return false;
    }
    const auto store = records::Store::open(options.records);
    return store ? (*store)->find(options.move.robot).has_value() : isNumber(options.move.robot);
}

Result<Exit> runPlot(const PlotOptions& options) {
    if (namesExecution(options)) {
        return drawExecution({.records = options.records,
                              .id = options.move.robot,
                              .robot = options.robot,
                              .tool = options.move.tool,
                              .title = options.title,
                              .svg = options.svg});
    }
    METIER_ASSIGN(const auto model, asUsage(loadRobot(options.move.robot)));
    METIER_ASSIGN(const auto motion, motionOf(model, options));
    return drawInto(options.svg, model, options.title, motion);
}

}  // namespace

void addPlot(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<PlotOptions>();
    auto* command = app.add_subcommand(
        "plot", "Draw a planned or recorded move against the limits of its axes, as SVG");
    command->footer(
        "Joint position, velocity, acceleration and jerk, the speed of the tool frame and its "
        "path,\n"
        "of the move that `metier check` plans from the same options, or of a record. In place of\n"
        "a robot: the number or id of an execution that `metier history` shows.");
    command
        ->add_option("ROBOT_OR_ID", options->move.robot,
                     "Which robot: ur5, ur5e, iiwa7, iiwa14, edo, or the file of a model; or which "
                     "recorded execution")
        ->required();
    addRecords(*command, options->records);
    command->add_option("--robot", options->robot,
                        "The robot of that execution; without it the one of its device's name");
    addMoveOptions(*command, options->move);
    command->add_option("--record", options->record,
                        "Draw this recorded motion instead: CSV lines time,q1,...,qn [s, rad], or "
                        "what `metier check --json` prints");
    command->add_option("--title", options->title,
                        "Above the picture; without it the robot's name");
    command->add_option("--svg", options->svg, "File to draw into; -: standard output")
        ->capture_default_str();
    command->callback([options, &context] { context.exit = exitOf(runPlot(*options)); });
}

}  // namespace metier::app
