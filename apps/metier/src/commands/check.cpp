#include <fmt/format.h>

#include <array>
#include <memory>

#include "command_context.hpp"
#include "joint_text.hpp"
#include "metier/path_evaluation/motion_curves.hpp"
#include "metier/path_evaluation/motion_record.hpp"
#include "planned_move.hpp"
#include "robot_argument.hpp"

namespace metier::app {
namespace {

using motion::Feasibility;
using motion::RobotModel;
using motion::Trajectory;
using nlohmann::ordered_json;
using path_evaluation::Quantity;

constexpr std::size_t kPeakSamples = 2001;

struct CheckOptions {
    MoveOptions move;
    std::size_t points = 101;
    std::string csv;
    bool json = false;
};

struct QuantityName {
    Quantity quantity;
    const char* name;
    const char* unit;
};
constexpr std::array kQuantities{
    QuantityName{Quantity::velocity, "velocity", "rad/s"},
    QuantityName{Quantity::acceleration, "acceleration", "rad/s2"},
    QuantityName{Quantity::jerk, "jerk", "rad/s3"},
};

void printRefusal(const PlannedMove& move, const motion::Refusal& refusal) {
    fmt::print("refused: {}\n", refusal.error.message);
    fmt::print("  move          {}\n", move.skill);
    fmt::print("  reason        {}\n", toString(refusal.reason));
    if (refusal.axis) {
        fmt::print("  axis          {}\n", *refusal.axis + 1);
    }
    if (refusal.fraction > 0) {
        fmt::print("  fails first   at {:.1f} % of the path\n", 100 * refusal.fraction);
    }
}

void printPlan(const RobotModel& model, const PlannedMove& move) {
    const Trajectory& plan = *move.plan;
    fmt::print("possible: takes {:.3f} s\n", plan.duration().count());
    fmt::print("  move          {}\n", move.skill);
    if (plan.length() > 0 || plan.angle() > 0) {
        fmt::print("  path          {:.4f} m, {:.4f} rad\n", plan.length(), plan.angle());
    }
    fmt::print("  from          {}\n", toText(plan.start()));
    fmt::print("  to            {}\n", toText(plan.end()));
    const auto samples = path_evaluation::sampleMotion(plan, kPeakSamples);
    for (const auto& [quantity, name, unit] : kQuantities) {
        const auto peak = peakOf(samples, model, quantity);
        fmt::print("  {:<13} up to {:.1f} % of its limit: axis {}, {:.4f} {} at {:.2f} s\n", name,
                   100 * peak.share, peak.axis + 1, peak.value, unit, peak.time);
    }
}

ordered_json refusalJson(const motion::Refusal& refusal) {
    return {{"reason", toString(refusal.reason)},
            {"code", toString(refusal.error.code)},
            {"message", refusal.error.message},
            {"axis", refusal.axis ? ordered_json(*refusal.axis + 1) : ordered_json()},
            {"fraction", refusal.fraction}};
}

ordered_json peaksJson(const RobotModel& model, const Trajectory& plan) {
    const auto samples = path_evaluation::sampleMotion(plan, kPeakSamples);
    ordered_json peaks;
    for (const auto& [quantity, name, unit] : kQuantities) {
        const auto peak = peakOf(samples, model, quantity);
        peaks[name] = {{"axis", peak.axis + 1},
                       {"share", peak.share},
                       {"value", peak.value},
                       {"time", peak.time}};
    }
    return peaks;
}

ordered_json previewJson(const Feasibility& feasibility) {
    auto list = ordered_json::array();
    const auto last = static_cast<double>(feasibility.preview.size() - 1);
    for (std::size_t i = 0; i < feasibility.preview.size(); ++i) {
        list.push_back({{"time", static_cast<double>(i) / last * feasibility.duration.count()},
                        {"joint_position", toJson(feasibility.preview[i])}});
    }
    return list;
}

ordered_json jsonOf(const RobotModel& model, const PlannedMove& move, std::size_t points) {
    const auto feasibility = motion::assess(move.plan, points);
    ordered_json json{{"robot", model.name()},
                      {"move", move.skill},
                      {"possible", !feasibility.refusal.has_value()},
                      {"start", toJson(move.start)}};
    if (feasibility.refusal) {
        json["refusal"] = refusalJson(*feasibility.refusal);
        return json;
    }
    json["duration"] = feasibility.duration.count();
    json["length"] = move.plan->length();
    json["angle"] = move.plan->angle();
    json["end"] = toJson(move.plan->end());
    json["end_pose"] = toJson(move.plan->endPose());
    json["peaks"] = peaksJson(model, *move.plan);
    json["preview"] = previewJson(feasibility);
    return json;
}

/// The planned joint positions at every cycle of the controller, and at the end.
Result<void> writeCsv(const std::string& file, const RobotModel& model, const Trajectory& plan) {
    path_evaluation::MotionRecord record;
    const double duration = plan.duration().count();
    for (double time = 0; time < duration;
         time = model.cycleTime() * static_cast<double>(record.size())) {
        record.push_back({time, plan.sample(motion::Seconds(time)).position});
    }
    record.push_back({duration, plan.end()});
    return writeFile(file, path_evaluation::toCsv(record));
}

Result<Exit> runCheck(const CheckOptions& options) {
    METIER_ASSIGN(const auto model, asUsage(loadRobot(options.move.robot)));
    METIER_ASSIGN(const auto move, asUsage(planMove(model, options.move)));
    if (move.plan && !options.csv.empty()) {
        METIER_TRY(writeCsv(options.csv, model, *move.plan));
    }
    if (options.json) {
        fmt::print("{}\n", jsonOf(model, move, options.points).dump(2));
    } else if (move.plan) {
        printPlan(model, move);
    } else {
        printRefusal(move, move.plan.error());
    }
    return move.plan ? Exit::success : Exit::failed;
}

}  // namespace

void addCheck(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<CheckOptions>();
    auto* command = app.add_subcommand(
        "check", "Report whether a move is possible and how it would run; needs no server");
    command->footer(
        "Plans as Start of the move skill does, with the same checks: what is possible here is\n"
        "started there, from the same joint positions. Refused: exit status 1.");
    addRobot(*command, options->move.robot);
    addMoveOptions(*command, options->move);
    within(command->add_option(
               "--points", options->points,
               "How many joint positions --json shows as preview, equally spaced in time"),
           2, 100'000);
    command->add_option("--csv", options->csv,
                        "Write the planned joint positions of every controller cycle into this "
                        "file: a heading, then lines time,q1,...,qn [s, rad]");
    command->add_flag("--json", options->json, "Print JSON, with a preview of the joint path");
    command->callback([options, &context] { context.exit = exitOf(runCheck(*options)); });
}

}  // namespace metier::app
