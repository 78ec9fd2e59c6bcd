#include "metier/robot_skills/gripper_skills.hpp"

#include <fmt/format.h>

#include <optional>
#include <string_view>
#include <utility>

#include "grip/gripper_report.hpp"
#include "grip/gripper_work.hpp"
#include "metier/base/numbers.hpp"
#include "metier/skill/typed_skill.hpp"

namespace metier::robot_skills {

using device::Gripper;
using device::GripperOutcome;
using skill::Field;
using skill::Range;

namespace {

using Parameters = skill::FieldList<GripperParameters>;
using Ask = Result<void> (Gripper::*)(const device::GripperRequest&, Gripper::Done);

/// Motion of the jaws that a skill asks for.
struct JawMotion {
    Ask ask;
    /// Errors: the gripper says that it is done, but its state says otherwise.
    Result<void> (*check)(const GripperOutcome&);
    bool needs_width = false;
};

/// Differences between the skills of a gripper.
struct Kind {
    skill::SkillDescription description;
    Parameters fields;
    JawMotion motion;
};

std::optional<double> unlessZero(double value) {
    return value == 0.0 ? std::nullopt : std::optional(value);
}

struct Limit {
    std::string_view name;
    std::string_view unit;
    Range range;
};

Result<void> checkWithin(double value, const Limit& limit) {
    if (value >= limit.range.low && value <= limit.range.high) {
        return {};
    }
    return fail(Errc::out_of_range,
                fmt::format("{}: {} {} is not within the gripper's {} to {} {}", limit.name, value,
                            limit.unit, limit.range.low, limit.range.high, limit.unit));
}

Result<void> checkRequest(const device::GripperRequest& request, const device::GripperInfo& info) {
    if (request.force && info.max_force == 0.0) {
        return fail(Errc::out_of_range,
                    fmt::format("Force: {} N, but {} has no force control; only 0 N is possible",
                                *request.force, info.name));
    }
    if (request.force) {
        METIER_TRY(checkWithin(*request.force, {"Force", "N", {info.min_force, info.max_force}}));
    }
    return request.width ? checkWithin(*request.width, {"Width", "m", {0.0, info.stroke}})
                         : Result<void>();
}

/// Whether the gripper could begin to move now.
Result<void> checkReady(const Gripper& gripper) {
    METIER_TRY(device::checkNormal(gripper.safety()));
    if (gripper.state().moving) {
        return fail(Errc::invalid_state, gripper.info().name + ": the jaws still move");
    }
    return {};
}

class GripperSkill final : public skill::TypedSkill<GripperParameters, GripperResults> {
public:
    GripperSkill(Gripper& gripper, Kind kind)
        : TypedSkill(std::move(kind.description), std::move(kind.fields), gripperResultFields()),
          gripper_(gripper),
          motion_(kind.motion) {}

    /// Errors: also timeout, while jaws that were asked to stop still move; call it again.
    Result<void> reset() override {
        if (moving_->load()) {
            return fail(Errc::timeout, gripper_.info().name + ": the jaws still move");
        }
        return gripper_.resetFault();
    }

protected:
    Result<std::unique_ptr<skill::ExecutionWork>> plan(
        const GripperParameters& parameters) override {
        device::GripperRequest request;
        request.force = unlessZero(parameters.force);
        request.width = motion_.needs_width ? parameters.width : unlessZero(parameters.width);
        METIER_TRY(checkReady(gripper_));
        METIER_TRY(checkRequest(request, gripper_.info()));
        return std::make_unique<GripperWork>(
            gripper_,
            [ask = motion_.ask, request](Gripper& gripper, Gripper::Done done) {
                return (gripper.*ask)(request, std::move(done));
            },
            [check = motion_.check](const GripperOutcome& outcome) {
                return check(outcome).map([&] {
                    return gripperResultFields().write({outcome.width, outcome.part_held});
                });
            },
            moving_);
    }

    Result<skill::CheckReport> assess(const GripperParameters& parameters) override {
        return gripperReport(plan(parameters).map([](const auto& /*work*/) {}));
    }

private:
    Gripper& gripper_;
    JawMotion motion_;
    GripperWork::Moving moving_ = std::make_shared<std::atomic<bool>>(false);
};

Field forceField(std::string description) {
    return {.name = "Force",
            .description = std::move(description),
            .unit = skill::kNewton,
            .range = Range{0.0, 1000.0},
            .default_value = 0.0};
}

Field widthField(std::string description) {
    return {.name = "Width",
            .description = std::move(description),
            .unit = skill::kMetre,
            .range = Range{0.0, 1.0}};
}

Field widthOption(std::string description) {
    auto field = widthField(std::move(description));
    field.place = skill::Place::options;
    field.default_value = 0.0;
    return field;
}

Parameters fields(Field force, Field width) {
    return Parameters()
        .add(&GripperParameters::force, std::move(force))
        .add(&GripperParameters::width, std::move(width));
}

/// The published types of grippers are called as their instances, without the word Type.
skill::SkillDescription describe(std::string name, std::string description) {
    return {.name = name, .type = name, .description = std::move(description)};
}

Result<void> checkHeld(const GripperOutcome& outcome) {
    if (outcome.part_held) {
        return {};
    }
    return fail(Errc::device_fault, fmt::format("no part found: the jaws closed to {:.1f} mm",
                                                outcome.width / kMillimetre));
}

Result<void> checkFree(const GripperOutcome& outcome) {
    if (!outcome.part_held) {
        return {};
    }
    return fail(Errc::device_fault,
                fmt::format("the part is still held at {:.1f} mm", outcome.width / kMillimetre));
}

Result<void> checkNothing(const GripperOutcome& /*outcome*/) {
    return {};
}

Kind graspKind() {
    return {describe("GraspGripperSkill", "Closes the jaws until they hold a part"),
            fields(forceField("Force to hold the part with; Null or 0: the gripper's own"),
                   widthOption("Expected width of the part; 0: not known")),
            {&Gripper::grasp, checkHeld}};
}

Kind releaseKind() {
    return {describe("ReleaseGripperSkill", "Opens the jaws and lets the part go"),
            fields(forceField("Largest force while opening; Null or 0: the gripper's own"),
                   widthOption("Distance between the jaws to open to; 0: the gripper's own")),
            {&Gripper::release, checkFree}};
}

Kind moveKind() {
    return {
        describe("MoveGripperSkill", "Moves the jaws to a width, whether or not there is a part"),
        fields(forceField("Largest force on the way; Null or 0: the gripper's own"),
               widthField("Distance between the jaws to move to")),
        {&Gripper::move, checkNothing, true}};
}

}  // namespace

const skill::FieldList<GripperResults>& gripperResultFields() {
    static const auto list =
        skill::FieldList<GripperResults>()
            .add(&GripperResults::width_reached,
                 Field{.name = "WidthReached",
                       .description = "Distance between the jaws when the skill ended",
                       .unit = skill::kMetre})
            .add(&GripperResults::part_held,
                 Field{.name = "PartHeld",
                       .description = "True if the gripper held a part when the skill ended"});
    return list;
}

GripperSkills makeGripperSkills(Gripper& gripper) {
    GripperSkills skills;
    skills.resource = std::make_shared<skill::Resource>("gripper " + gripper.info().name);
    for (auto* kind : {graspKind, releaseKind, moveKind}) {
        skills.skills.push_back(std::make_unique<GripperSkill>(gripper, kind()));
    }
    return skills;
}

}  // namespace metier::robot_skills
