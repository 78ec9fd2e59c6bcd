#include <fmt/format.h>

#include <fstream>
#include <memory>

#include "joint_text.hpp"
#include "metier/path_evaluation/motion_drawing.hpp"
#include "planned_move.hpp"
#include "robot_argument.hpp"

namespace metier::app {
namespace {

using motion::RobotModel;
using path_evaluation::MotionSample;

/// Enough for a curve of 560 px, whatever bends it has.
constexpr std::size_t kSamples = 1501;

struct PlotOptions {
    MoveOptions move;
    std::string record;
    std::string title;
    std::string svg = "motion.svg";
};

/// What is drawn.
struct Motion {
    std::vector<MotionSample> samples;
    std::vector<Eigen::Vector3d> tool_positions;
    std::string note;
    std::optional<double> asked_speed;
};

std::string nameOf(const RobotModel& model) {
    return std::string(model.product().empty() ? model.name() : model.product());
}

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

Result<Motion> plannedMotion(const RobotModel& model, const MoveOptions& options) {
    const auto move = planMove(model, options);
    if (!move) {
        return fail(move.error());
    }
    if (!move->plan) {
        return fail(Errc::unreachable, move->plan.error().error.message);
    }
    Motion motion;
    motion.samples = path_evaluation::sampleMotion(*move->plan, kSamples);
    for (const auto& sample : motion.samples) {
        motion.tool_positions.push_back(move->plan->toolPose(sample.position).translation);
    }
    motion.note = fmt::format("{}, {:.3f} s", move->skill, move->plan->duration().count());
    if (move->plan->length() > 0) {
        motion.note += fmt::format(", {:.4f} m", move->plan->length());
    }
    motion.asked_speed = askedSpeed(model, options);
    return motion;
}

Result<Motion> recordedMotion(const RobotModel& model, const PlotOptions& options) {
    const auto record = path_evaluation::loadRecord(options.record);
    if (!record) {
        return fail(Errc::invalid_argument, record.error().message);
    }
    const auto tool = model.tool(options.move.tool);
    if (!tool) {
        return fail(Errc::invalid_argument, tool.error().message);
    }
    if (record->front().position.size() != model.axisCount()) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: {} joint positions, {} has {} axes", options.record,
                                record->front().position.size(), model.name(), model.axisCount()));
    }
    Motion motion;
    motion.samples = path_evaluation::sampleMotion(*record);
    for (const auto& [time, position] : *record) {
        const auto pose = model.kinematics().forward(position) * tool->flange_from_tool;
        motion.tool_positions.push_back(pose.translation);
    }
    motion.note = fmt::format("{}, {} positions, {:.3f} s", options.record, record->size(),
                              motion.samples.back().time);
    return motion;
}

Result<Motion> motionOf(const RobotModel& model, const PlotOptions& options) {
    if (options.record.empty()) {
        return plannedMotion(model, options.move);
    }
    if (hasTarget(options.move)) {
        return fail(Errc::invalid_argument, "--record and a target exclude each other");
    }
    return recordedMotion(model, options);
}

Result<void> write(const std::string& file, const std::string& svg) {
    if (file == "-") {
        fmt::print("{}", svg);
        return {};
    }
    std::ofstream out(file);
    out << svg;
    out.close();
    if (!out) {
        return fail(Errc::invalid_argument, fmt::format("{}: cannot be written", file));
    }
    fmt::print(stderr, "drawn in {}\n", file);
    return {};
}

Exit runPlot(const PlotOptions& options) {
    const auto model = loadRobot(options.move.robot);
    if (!model) {
        return reportUsage(model.error());
    }
    const auto motion = motionOf(*model, options);
    if (!motion) {
        return report(motion.error());
    }
    const auto svg = path_evaluation::drawMotion(
        *model, {options.title.empty() ? nameOf(*model) : options.title, motion->note,
                 motion->samples, motion->tool_positions, motion->asked_speed});
    if (!svg) {
        return report(svg.error());
    }
    const auto written = write(options.svg, *svg);
    return written ? Exit::success : reportUsage(written.error());
}

}  // namespace

void addPlot(CLI::App& app, Exit& exit) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<PlotOptions>();
    auto* command = app.add_subcommand(
        "plot", "Draw a planned or recorded move against the limits of its axes, as SVG");
    command->footer(
        "Joint position, velocity, acceleration and jerk, the speed of the tool frame and its "
        "path,\n"
        "of the move that `metier check` plans from the same options, or of a record.");
    addRobot(*command, options->move.robot);
    addMoveOptions(*command, options->move);
    command->add_option("--record", options->record,
                        "Draw this recorded motion instead: CSV lines time,q1,...,qn [s, rad], or "
                        "what `metier check --json` prints");
    command->add_option("--title", options->title,
                        "Above the picture; without it the robot's name");
    command->add_option("--svg", options->svg, "File to draw into; -: standard output")
        ->capture_default_str();
    command->callback([options, &exit] { exit = runPlot(*options); });
}

}  // namespace metier::app
