#include "arm_body.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace metier::robot_skills {

using device::SafetyState;
using skill::Reason;
using Request = ExecutionSource::Request;

ArmBody::ArmBody(device::Arm& arm, std::shared_ptr<ExecutionSource> source,
                 ToolDistance tool_distance)
    : arm_(arm), source_(std::move(source)), tool_distance_(std::move(tool_distance)) {}

ArmBody::~ArmBody() {
    source_->request(Request::halt);
}

void ArmBody::start(skill::Execution execution) {
    execution_ = std::move(execution);
    watchSafety();
    source_->begin(execution_);
    if (auto attached = arm_.attach(source_); !attached) {
        source_->abandon();
        execution_.fail(Reason::error, attached.error().message);
    }
}

/// While the motion rests the arm has no source to tell that its safety state changed.
void ArmBody::watchSafety() {
    safety_watch_ = arm_.onSafetyChange(
        [source = source_, execution = execution_](const device::Safety& safety) {
            if (safety.state == SafetyState::normal || source->attached()) {
                return;
            }
            const bool lost = safety.state == SafetyState::disconnected;
            execution.fail(lost ? Reason::device_lost : Reason::error, safety.text);
        });
}

Result<void> ArmBody::suspend() {
    source_->request(Request::suspend);
    return {};
}

Result<void> ArmBody::resume() {
    const auto state = arm_.state();
    if (auto checked = checkNotMoved(state.position); !checked) {
        return checked;
    }
    source_->beginAgain(state.commanded_position);
    auto attached = arm_.attach(source_);
    if (!attached) {
        source_->abandon();
    }
    return attached;
}

Result<void> ArmBody::checkNotMoved(const device::JointArray& position) const {
    const auto rest = source_->restingPlace();
    std::size_t worst = 0;
    for (std::size_t axis = 0; axis < rest.size(); ++axis) {
        if (std::abs(position[axis] - rest[axis]) > std::abs(position[worst] - rest[worst])) {
            worst = axis;
        }
    }
    const double moved = std::abs(position[worst] - rest[worst]);
    if (moved <= kMovedTolerance) {
        return {};
    }
    return fail(
        Errc::out_of_range,
        fmt::format("the arm was moved while it was suspended: axis {} by {:.4f} rad, limit "
                    "{} rad; the tool frame by {:.4f} m",
                    worst + 1, moved, kMovedTolerance, tool_distance_(position, rest)));
}

void ArmBody::halt() {
    if (source_->attached()) {
        source_->request(Request::halt);
    } else {
        execution_.atRest();
    }
}

void ArmBody::forceStop() noexcept {
    if (source_->attached()) {
        arm_.stop();
    }
}

}  // namespace metier::robot_skills
