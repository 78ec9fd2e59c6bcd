#include "metier/robot_skills/position_stream_skill.hpp"

#include <fmt/format.h>

#include <utility>

#include "conversions.hpp"
#include "metier/robot_skills/move_parameters.hpp"
#include "metier/skill/typed_skill.hpp"
#include "moves/arm_skill.hpp"
#include "moves/source_work.hpp"
#include "stream/stream_input.hpp"
#include "stream/stream_source.hpp"

namespace metier::robot_skills {

using motion::JointVector;
using motion::RobotModel;
using skill::Field;
using skill::Value;

namespace {

constexpr std::string_view kTarget = "TargetJointPosition";
constexpr std::string_view kEndOfStream = "EndOfStream";
constexpr double kLongestPlayOutDelay = 0.5;  // [s]

Result<void> checkWithinLimits(const RobotModel& model, const std::vector<double>& position) {
    for (std::size_t axis = 0; axis < position.size(); ++axis) {
        const auto& limits = model.limits(axis);
        if (position[axis] < limits.lower || position[axis] > limits.upper) {
            return fail(Errc::out_of_range,
                        fmt::format("axis {}: {:.4f} rad is outside {:.4f} to {:.4f} rad", axis + 1,
                                    position[axis], limits.lower, limits.upper));
        }
    }
    return {};
}

/// A stream as an execution of its skill.
class StreamWork final : public SourceWork {
public:
    /// Source and target of the set-points.
    struct Stream {
        std::shared_ptr<StreamSource> source;  // shared with the arm while it moves
        StreamTimes times;
        std::optional<std::vector<double>> first;
        std::shared_ptr<StreamReport> report;  // shared with those who publish it
    };

    StreamWork(device::Arm& arm, Stream stream, ToolPose tool_pose)
        : SourceWork(arm, stream.source, std::move(tool_pose)), stream_(std::move(stream)) {}

    void start(skill::ExecutionHandle execution) override {
        stream_.report->restart();
        stream_.times.restart();
        const auto begun = stream_.first ? push(*stream_.first, {}) : Result<void>{};
        if (!begun) {
            execution.fail(skill::Reason::error, begun.error().message);
            return;
        }
        SourceWork::start(std::move(execution));
    }

    Result<void> resume() override {
        stream_.times.restart();
        return SourceWork::resume();
    }

    Result<void> input(std::string_view parameter, const skill::LiveValue& live) override {
        if (const auto* ends = std::get_if<bool>(&live.value);
            parameter == kEndOfStream && ends != nullptr) {
            if (*ends) {
                stream_.source->finish();
            }
            return {};
        }
        const auto* values = std::get_if<std::vector<double>>(&live.value);
        if (parameter != kTarget || values == nullptr) {
            return ExecutionWork::input(parameter, live);
        }
        return push(*values, live.meant_for);
    }

    void inputRefused(std::string_view /*parameter*/, const Error& why) override {
        stream_.report->noteRefused(why.message);
    }

private:
    Result<void> push(const std::vector<double>& values, std::optional<UtcTime> meant_for = {}) {
        if (stream_.source->finishing()) {
            return fail(Errc::invalid_state,
                        fmt::format("{}: no set-point is taken after {}", kTarget, kEndOfStream));
        }
        METIER_ASSIGN(auto position, JointVector::from(values));
        const auto time = stream_.times.next(meant_for);
        stream_.report->noteClockStep(stream_.times.clockStep().count());
        if (!stream_.source->queue().tryPush({position, time})) {
            return fail(Errc::resource_unavailable,
                        fmt::format("{}: {} set-points wait already, more than the arm can take",
                                    kTarget, StreamQueue::kCapacity));
        }
        return {};
    }

    Stream stream_;
};

class PositionStreamSkill final
    : public skill::TypedSkill<PositionStreamParameters, PositionStreamResults> {
public:
    PositionStreamSkill(device::Arm& arm, const RobotModel& model, const Clock& clock,
                        const PositionStreamOptions& options)
        : TypedSkill({.name = "PositionStreamSkill",
                      .type = "PositionStreamSkillType",
                      .description = "Follows joint positions that are written while it runs",
                      .on_owner_loss = skill::OwnerLossAction::halt},
                     positionStreamFields(model), positionStreamResultFields()),
          arm_(arm),
          model_(model),
          clock_(clock),
          options_(options) {}

    Result<void> reset() override { return resetArm(arm_); }

protected:
    Result<std::unique_ptr<skill::ExecutionWork>> plan(
        const PositionStreamParameters& given) override {
        METIER_TRY(checkReady(arm_));
        METIER_ASSIGN(auto source,
                      StreamSource::create(model_, {arm_.info().cycleSeconds(),
                                                    toVector(arm_.state().commanded_position),
                                                    given.play_out_delay, options_}));
        if (given.target_joint_position) {
            METIER_ASSIGN(const auto first, JointVector::from(*given.target_joint_position));
            METIER_TRY(source->checkFirst(first));
        }
        const auto arrivals = given.play_out_delay == 0.0 ? StreamTimes::Arrivals::rhythm
                                                          : StreamTimes::Arrivals::each;
        return std::make_unique<StreamWork>(
            arm_,
            StreamWork::Stream{std::move(source), StreamTimes(clock_, arm_.info().cycle, arrivals),
                               given.target_joint_position, options_.report},
            [&model = model_](const JointVector& joints) {
                return model.kinematics().forward(joints);
            });
    }

private:
    device::Arm& arm_;
    const RobotModel& model_;
    const Clock& clock_;
    const PositionStreamOptions options_;
};

}  // namespace

skill::FieldList<PositionStreamParameters> positionStreamFields(const RobotModel& model) {
    const auto axes = model.axisCount();
    skill::FieldList<PositionStreamParameters> fields;
    fields.add(&PositionStreamParameters::target_joint_position,
               Field{.name = std::string(kTarget),
                     .description = "Joint position to follow, axis 1 first",
                     .unit = skill::kRadian,
                     .range = jointRangeOf(model),
                     .length = skill::LengthLimit{axes, axes},
                     .input = skill::Input::live,
                     .extra_check = [&model](const Value& value) {
                         return checkWithinLimits(model, std::get<std::vector<double>>(value));
                     }});
    fields.add(&PositionStreamParameters::play_out_delay,
               Field{.name = "PlayOutDelay",
                     .description = "From the time a set-point is meant for until the arm is sent "
                                    "it; not set: 20 ms, at least three cycles; 0: at once",
                     .unit = skill::kSecond,
                     .range = skill::Range{0.0, kLongestPlayOutDelay},
                     .place = skill::Place::options});
    fields.add(&PositionStreamParameters::end_of_stream,
               Field{.name = std::string(kEndOfStream),
                     .description = "Write true after the last set-point: the stream ends when the "
                                    "arm stands there; before Start it means nothing",
                     .place = skill::Place::options,
                     .input = skill::Input::live});
    return fields;
}

const skill::FieldList<PositionStreamResults>& positionStreamResultFields() {
    static const auto fields =
        skill::FieldList<PositionStreamResults>()
            .add(&PositionStreamResults::set_points,
                 Field{.name = "SetPoints", .description = "Number of set-points followed"})
            .add(&PositionStreamResults::missed_cycles,
                 Field{.name = "MissedCycles",
                       .description = "Control cycles without a set-point in time"})
            .add(&PositionStreamResults::duration, Field{.name = "Duration",
                                                         .description = "Time from Running to rest",
                                                         .unit = skill::kSecond})
            .add(&PositionStreamResults::largest_lag,
                 Field{.name = "LargestStreamLag",
                       .description = "Most that a set-point waited longer than PlayOutDelay",
                       .unit = skill::kSecond})
            .add(&PositionStreamResults::clock_step,
                 Field{.name = "StreamClockStep",
                       .description = "Largest step of the client's clock between two set-points, "
                                      "below 0: back",
                       .unit = skill::kSecond})
            .add(&PositionStreamResults::refused_set_points,
                 Field{.name = "RefusedSetPoints",
                       .description = "Number of set-points refused when they were written"})
            .add(&PositionStreamResults::dropped_set_points,
                 Field{.name = "DroppedSetPoints",
                       .description = "Number of set-points dropped, since their time was not "
                                      "after the one before"});
    return fields;
}

std::unique_ptr<skill::Skill> makePositionStreamSkill(device::Arm& arm, const RobotModel& model,
                                                      const Clock& clock,
                                                      const PositionStreamOptions& options) {
    return std::make_unique<PositionStreamSkill>(arm, model, clock, options);
}

}  // namespace metier::robot_skills
