#include "synchronized/arm_move.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace metier::composition {

using composition::ClockOffset;
using composition::UsedSkillEnd;
using skill::CheckReport;
using skill::Reason;

namespace {

const std::string kStopTime = "StopTime";
constexpr double kLongestStop = 3.0;  // longest StopTime that arms take [s]

double seconds(std::chrono::nanoseconds time) {
    return std::chrono::duration<double>(time).count();
}

}  // namespace

ArmMove::~ArmMove() {
    *alive_ = false;
    if (underWay()) {
        setup_.arm.joint_move->release();
    }
}

ArmFailure ArmMove::failure(const std::string& text, Reason reason) const {
    return {reason, fmt::format("{} {}", name(), text)};
}

void ArmMove::ask(Done done) {
    if (!joint_path_.empty()) {
        askJointMove(std::move(done));
        return;
    }
    setup_.arm.pose_move->check(
        {.parameters = {{"TargetPosition", setup_.target}, {"ToolFrame", setup_.tool_frame}}},
        whileAlive<CheckReport>([this, done = std::move(done)](const auto& report) {
            if (const auto failed = checkPossible(report)) {
                done(failed);
                return;
            }
            joint_path_ = report->joint_path;
            askJointMove(done);
        }));
}

/// The skill that will move the arm has the last word.
void ArmMove::askJointMove(Done done) {
    setup_.arm.joint_move->check(
        {.parameters = {{"TargetJointPosition", joint_path_.back()},
                        {"ToolFrame", setup_.tool_frame}}},
        whileAlive<CheckReport>([this, done = std::move(done)](const auto& report) {
            if (const auto failed = checkPossible(report)) {
                done(failed);
                return;
            }
            shortest_ = report->planned_duration;
            braking_ = brakingTime(report->joint_path, shortest_);
            const auto off = offPath(joint_path_, report->joint_path.front());
            done(off.empty() ? std::optional<ArmFailure>()
                             : failure("was moved off its way: " + off));
        }));
}

std::optional<ArmFailure> ArmMove::checkPossible(const Result<CheckReport>& report) const {
    if (!report) {
        const bool lost =
            report.error().code == Errc::connection_lost || report.error().code == Errc::timeout;
        return failure("does not answer: " + report.error().message,
                       lost ? Reason::device_lost : Reason::error);
    }
    if (!report->possible) {
        const auto& move = *setup_.arm.joint_move;
        const auto why = move.reasonText();
        const bool halted = move.state() == skill::State::halted && !why.empty() &&
                            report->reason.find(why) == std::string::npos;
        return failure(fmt::format("cannot get to its target: {}{}", report->reason,
                                   halted ? " (" + why + ")" : ""));
    }
    if (report->joint_path.empty()) {
        return failure("does not publish the joint positions on its way");
    }
    return std::nullopt;
}

void ArmMove::compareClocks(Done done) {
    setup_.arm.joint_move->compareClocks(
        [this, done = std::move(done)](const Result<ClockOffset>& offset) {
            if (!offset) {
                done(failure("does not publish its time: " + offset.error().message,
                             Reason::device_lost));
                return;
            }
            offset_ = *offset;
            done(std::nullopt);
        });
}

/// If a motion is slowed down by a factor, it brakes from a speed that is less by that factor: the
/// braking time falls with the factor where acceleration limits it, with its root where jerk does.
/// A motion at its limits brakes at its end with all that the axes have, so the pace can fall only
/// slowly there. Both numbers are upper bounds for random moves of all arms (tests:
/// StopTime.IsTakenByArmsOfAllKinds...).
double ArmMove::stopTime(double duration) const noexcept {
    constexpr double slow = 1.15;
    // Slowness, as a share of the shortest duration, at which the end of the way matters less.
    constexpr double reserve = 0.1;
    const double slowed = shortest_ > 0.0 ? std::max(duration / shortest_, 1.0) : 1.0;
    const double needed = slow / std::sqrt(slowed) + std::exp(-(slowed - 1.0) / reserve);
    return std::min(braking_ * needed, kLongestStop);
}

void ArmMove::begin(const Start& start) {
    const auto time = start.time.time_since_epoch() + offset_.ahead;
    skill::StartRequest request{.execution_id = start.execution_id,
                                .on_owner_loss = skill::OwnerLossAction::halt,
                                .parent = {.id = start.parent}};
    request.parameters = {{"TargetJointPosition", joint_path_.back()},
                          {"ToolFrame", setup_.tool_frame},
                          {"StartTime", std::chrono::duration<double>(time).count()}};
    if (hasPath()) {
        request.parameters.emplace("Duration", start.duration);
    }
    if (skill::findField(setup_.arm.joint_move->description().parameters, kStopTime) != nullptr) {
        request.parameters.emplace(kStopTime, start.stop_time);
    }
    stage_ = Stage::runs;
    rest_asked_ = halt_asked_ = false;
    setup_.arm.halted_by_us = false;
    setup_.arm.joint_move->begin(std::move(request), *this);
}

void ArmMove::suspend() {
    if (stage_ != Stage::runs || rest_asked_ || halt_asked_) {
        return;
    }
    rest_asked_ = true;
    if (const auto asked = setup_.arm.joint_move->suspend(); !asked) {
        owner_.failed(failure("refused Suspend: " + asked.error().message));
    }
}

bool ArmMove::needsReset() const {
    return stage_ == Stage::resting || (stage_ == Stage::idle && setup_.arm.mayReset() &&
                                        setup_.arm.joint_move->state() == skill::State::halted);
}

void ArmMove::drop() {
    stage_ = Stage::dropping;
    if (const auto asked = setup_.arm.joint_move->reset(*this); !asked) {
        stage_ = Stage::idle;
        owner_.failed(failure("refused Reset: " + asked.error().message));
    }
}

void ArmMove::halt() {
    if (!underWay() || halt_asked_) {
        return;
    }
    halt_asked_ = true;
    setup_.arm.halted_by_us = true;
    setup_.arm.joint_move->halt();
}

void ArmMove::onReset(const Result<void>& outcome) {
    if (stage_ != Stage::dropping) {
        return;
    }
    stage_ = Stage::idle;
    if (outcome) {
        owner_.changed();
    } else {
        owner_.failed(failure("refused Reset: " + outcome.error().message));
    }
}

void ArmMove::onSuspended() {
    stage_ = Stage::resting;
    if (!std::exchange(rest_asked_, true)) {
        owner_.suspendedByOther(fmt::format("{} was suspended", name()));
    }
    owner_.changed();
}

void ArmMove::onResumed() {
    stage_ = Stage::runs;
    rest_asked_ = false;
    owner_.failed(failure("was resumed alone"));
}

void ArmMove::onRefused(skill::Method method, const Error& error) {
    // An arm that ends by itself meanwhile refuses, and reports its end.
    if (method != skill::Method::suspend) {
        owner_.failed(failure(fmt::format("refused {}: {}", toString(method), error.message)));
    }
}

ArmFailure ArmMove::failureOf(const UsedSkillEnd& end) const {
    switch (end.kind) {
        case UsedSkillEnd::Kind::refused:
            return failure("refused Start: " + end.text);
        case UsedSkillEnd::Kind::lost:
            return failure("is lost: " + end.text, Reason::device_lost);
        default:
            break;
    }
    return haltedFailure(end.reason, end.text);
}

ArmFailure ArmMove::haltedFailure(Reason reason, const std::string& text) const {
    const bool by_someone =
        reason == Reason::by_client || reason == Reason::owner_lost || reason == Reason::none;
    return failure(
        fmt::format("was Halted ({}){}{}", skill::toString(reason), text.empty() ? "" : ": ", text),
        by_someone ? Reason::error : reason);
}

/// The others must brake now, not once this arm stands.
void ArmMove::onStopping(const composition::UsedSkillStop& stop) {
    if (stage_ != Stage::runs || halt_asked_) {
        return;
    }
    if (stop.to == skill::State::halted) {
        halt_asked_ = true;  // by another client: do not reset it from here
        owner_.failed(haltedFailure(stop.reason, stop.text));
    } else if (!std::exchange(rest_asked_, true)) {
        owner_.suspendedByOther(fmt::format("{} was suspended {}", name(), stop.text));
    }
}

void ArmMove::onEnd(UsedSkillEnd end) {
    const bool dropped = stage_ == Stage::dropping && end.kind == UsedSkillEnd::Kind::halted &&
                         setup_.arm.joint_move->state() == skill::State::ready;
    if (end.kind == UsedSkillEnd::Kind::finished) {
        stage_ = Stage::arrived;
        result_ = std::move(end.result);
        owner_.changed();
    } else if (dropped) {
        stage_ = Stage::idle;
        owner_.changed();
    } else {
        stage_ = Stage::over;
        setup_.arm.halted_by_us = setup_.arm.halted_by_us || end.kind == UsedSkillEnd::Kind::lost;
        if (halt_asked_) {
            owner_.changed();
        } else {
            owner_.failed(failureOf(end));
        }
    }
}

double ArmMove::number(const std::string& name) const {
    const auto found = result_.find(name);
    const auto* value = found == result_.end() ? nullptr : std::get_if<double>(&found->second);
    return value == nullptr ? 0.0 : *value;
}

double ArmMove::localTime(const std::string& name) const {
    return number(name) - seconds(offset_.ahead);
}

}  // namespace metier::composition
