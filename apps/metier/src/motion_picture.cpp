#include "motion_picture.hpp"

#include <fmt/format.h>

#include "metier/path_evaluation/motion_drawing.hpp"
#include "metier/records/json.hpp"

namespace metier::app {
namespace {

Result<void> write(const std::string& file, const std::string& svg) {
    if (file == "-") {
        fmt::print("{}", svg);
        return {};
    }
    METIER_TRY(writeFile(file, svg));
    fmt::print(stderr, "drawn in {}\n", file);
    return {};
}

std::string titleOf(const records::ExecutionRow& execution) {
    return fmt::format("{} of {}, {}, {}", execution.skill,
                       execution.device.empty() ? execution.server_name : execution.device,
                       records::timeText(execution.started), execution.state);
}

}  // namespace

std::string titleOf(const motion::RobotModel& model) {
    return std::string(model.product().empty() ? model.name() : model.product());
}

Result<DrawnMotion> recordedMotion(const motion::RobotModel& model,
                                   const path_evaluation::MotionRecord& record,
                                   const std::string& name, const std::string& tool) {
    const auto frame = model.tool(tool);
    if (!frame) {
        return fail(Errc::invalid_argument, frame.error().message);
    }
    if (record.front().position.size() != model.axisCount()) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: {} joint positions, {} has {} axes", name,
                                record.front().position.size(), model.name(), model.axisCount()));
    }
    DrawnMotion motion;
    motion.samples = path_evaluation::sampleMotion(record);
    for (const auto& [time, position] : record) {
        const auto pose = model.kinematics().forward(position) * frame->flange_from_tool;
        motion.tool_positions.push_back(pose.translation);
    }
    motion.note =
        fmt::format("{}, {} positions, {:.3f} s", name, record.size(), motion.samples.back().time);
    return motion;
}

Result<Exit> drawInto(const std::string& file, const motion::RobotModel& model,
                      const std::string& title, const DrawnMotion& motion) {
    METIER_ASSIGN(const auto svg,
                  path_evaluation::drawMotion(
                      model, {title.empty() ? titleOf(model) : title, motion.note, motion.samples,
                              motion.tool_positions, motion.asked_speed}));
    METIER_TRY(write(file, svg));
    return Exit::success;
}

Result<Exit> drawExecution(const ExecutionDrawing& drawing) {
    METIER_ASSIGN(const auto store, records::Store::open(drawing.records));
    METIER_ASSIGN(const auto execution, store->find(drawing.id));
    METIER_ASSIGN(const auto record, pathOf(*store, execution));
    METIER_ASSIGN(const auto model, asUsage(robotOf(execution, drawing.robot)));
    METIER_ASSIGN(
        const auto motion,
        recordedMotion(model, record, fmt::format("execution {}", execution.number), drawing.tool));
    return drawInto(drawing.svg, model, drawing.title.empty() ? titleOf(execution) : drawing.title,
                    motion);
}

}  // namespace metier::app
