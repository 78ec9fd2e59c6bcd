#include "metier/composition/synchronized_move_skill.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <utility>

#include "synchronized/synchronized_check.hpp"
#include "synchronized/synchronized_work.hpp"

namespace metier::composition {

using skill::State;

namespace {

constexpr std::size_t kMostArmChecks = 16;

std::vector<std::string> namesOf(const std::vector<Arm>& arms) {
    std::vector<std::string> names;
    for (const auto& arm : arms) {
        names.push_back(arm.name);
    }
    return names;
}

skill::SkillDescription describeMove() {
    return {.name = "SynchronizedMoveSkill",
            .type = "SynchronizedMoveSkillType",
            .description = "Moves several arms so that they start and arrive together",
            .on_owner_loss = skill::OwnerLossAction::halt};
}

Result<void> checkCounts(const Parameters& parameters) {
    const auto arms = parameters.arms.size();
    if (parameters.target_poses.size() != arms) {
        return fail(Errc::invalid_argument, fmt::format("TargetPoses: {} poses for {} arms",
                                                        parameters.target_poses.size(), arms));
    }
    if (!parameters.tool_frames.empty() && parameters.tool_frames.size() != arms) {
        return fail(Errc::invalid_argument, fmt::format("ToolFrames: {} names for {} arms",
                                                        parameters.tool_frames.size(), arms));
    }
    return {};
}

Result<void> checkReachable(const Arm& arm) {
    for (const auto* move : {arm.pose_move.get(), arm.joint_move.get()}) {
        if (const auto available = move->available(); !available) {
            return fail(available.error().code, fmt::format("{} cannot be reached: {}", arm.name,
                                                            available.error().message));
        }
    }
    return {};
}

}  // namespace

SynchronizedMoveSkill::SynchronizedMoveSkill(std::vector<Arm> arms, Options options)
    : TypedSkill(describeMove(), parameterFields(namesOf(arms)), resultFields()),
      arms_(std::move(arms)),
      options_(std::move(options)) {}

SynchronizedMoveSkill::~SynchronizedMoveSkill() = default;

Result<Arm*> SynchronizedMoveSkill::find(const std::string& name) {
    const auto found =
        std::find_if(arms_.begin(), arms_.end(), [&](const Arm& arm) { return arm.name == name; });
    if (found == arms_.end()) {
        return fail(Errc::invalid_argument, fmt::format("Arms: there is no \"{}\"; there are: {}",
                                                        name, fmt::join(namesOf(arms_), ", ")));
    }
    return &*found;
}

Result<std::vector<ArmTarget>> SynchronizedMoveSkill::targetsOf(const Parameters& parameters) {
    METIER_TRY(checkCounts(parameters));
    std::vector<ArmTarget> targets;
    std::set<std::string> taken;
    for (std::size_t i = 0; i < parameters.arms.size(); ++i) {
        METIER_ASSIGN(const auto arm, find(parameters.arms[i]));
        if (!taken.insert(parameters.arms[i]).second) {
            return fail(Errc::invalid_argument,
                        fmt::format("Arms: \"{}\" is there twice", parameters.arms[i]));
        }
        METIER_TRY(checkReachable(*arm));
        targets.push_back(
            {*arm, parameters.target_poses[i],
             parameters.tool_frames.empty() ? std::string() : parameters.tool_frames[i]});
    }
    return targets;
}

Result<std::unique_ptr<skill::ExecutionWork>> SynchronizedMoveSkill::plan(
    const Parameters& parameters) {
    METIER_ASSIGN(auto targets, targetsOf(parameters));
    return std::make_unique<SynchronizedWork>(
        SynchronizedWork::Setup{options_, std::move(targets), parameters.duration});
}

void SynchronizedMoveSkill::assessFrom(const skill::ArmPositions& starts,
                                       const Parameters& parameters, skill::CheckDone done) {
    std::erase_if(checks_, [](const auto& check) { return check->over(); });
    auto targets = targetsOf(parameters);
    if (targets && checks_.size() >= kMostArmChecks) {
        targets = fail(Errc::resource_unavailable,
                       fmt::format("{} checks are under way", checks_.size()));
    }
    if (!targets) {
        done(fail(targets.error()));
        return;
    }
    checks_.push_back(
        std::make_unique<SynchronizedCheck>(std::move(*targets), parameters.duration));
    checks_.back()->start(starts, *options_.executor, std::move(done));
}

Result<void> SynchronizedMoveSkill::reset() {
    for (auto& arm : arms_) {
        auto& move = *arm.joint_move;
        if (!arm.mayReset() || !move.available() || move.state() != State::halted) {
            continue;
        }
        if (const auto asked = move.reset(unheard_); !asked) {
            return fail(asked.error().code,
                        fmt::format("{} refused Reset: {}", arm.name, asked.error().message));
        }
    }
    return {};
}

std::string unfitReason(const skill::SkillDescription& joint_move) {
    for (const auto* name : {"TargetJointPosition", "ToolFrame", "Duration", "StartTime"}) {
        if (skill::findField(joint_move.parameters, name) == nullptr) {
            return fmt::format("{} has no parameter {}", joint_move.name, name);
        }
    }
    return "";
}

}  // namespace metier::composition
